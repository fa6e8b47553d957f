"""Contacts of particles in any file: ``python3 examples/any_file.py FILE [RADIUS]``.

Other libraries read what contactbench does not: meshio reads meshes (vtu, vtp, ply, xdmf), ase and
ovito read files of atoms and particles (cif, pdb, gsd, dump). Each needs three lines.
"""

import sys

import contactbench


def with_meshio(path, radius=None):
    import meshio

    mesh = meshio.read(path)
    radii = mesh.point_data["radius"] if radius is None else radius
    return contactbench.contacts(mesh.points, radii)


def with_ase(path, radius):
    import ase.io

    atoms = ase.io.read(path)
    box = contactbench.Box(atoms.cell[:], atoms.pbc) if atoms.pbc.any() else None
    return contactbench.contacts(atoms.positions, radius, box)


def with_ovito(path, radius=None):
    from ovito.io import import_file

    data = import_file(path).compute()
    box = contactbench.Box(data.cell[:, :3].T, data.cell.pbc) if any(data.cell.pbc) else None
    radii = data.particles["Radius"][...] if radius is None else radius
    return contactbench.contacts(data.particles.positions[...], radii, box)


if __name__ == "__main__":
    path, *radius = sys.argv[1:]
    read = with_ase if radius else with_meshio
    pairs, _ = read(path, *map(float, radius))
    print(f"{len(pairs)} contacts")
