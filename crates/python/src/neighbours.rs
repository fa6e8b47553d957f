//! Arrays of a neighbour list, made from the contacts of particles of equal radii.

use contactbench_ground::limits::refusal::{Refusal, reserve};
use contactbench_ground::periodic::ContactList;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArrayDyn};
use pyo3::prelude::*;

use crate::given::{Arrays, Edges, rows};
use crate::search::Search;

/// The form of a list, and the arrays to return beside i, j and the offsets.
#[derive(Clone, Copy, FromPyObject)]
pub struct Wanted {
    /// Each pair once, with i <= j, instead of from both sides.
    #[pyo3(item)]
    half: bool,
    /// Rows ordered by j and shift.
    #[pyo3(item)]
    sorted: bool,
    /// Shifts S.
    #[pyo3(item)]
    shifts: bool,
    /// Distance vectors D and distances d.
    #[pyo3(item)]
    vectors: bool,
}

type Lists = (
    Py<PyArray1<i64>>,
    Py<PyArray1<i64>>,
    Py<PyArray1<i64>>,
    Option<Py<PyArray2<i32>>>,
    Option<Py<PyArray2<f64>>>,
    Option<Py<PyArray1<f64>>>,
);

/// A neighbour list: entries of particle i lie between offsets i and i + 1.
struct NeighbourList {
    offsets: Vec<i64>,
    j: Vec<i64>,
    /// Shifts, or nothing if they are not needed.
    shifts: Vec<[i32; 3]>,
}

/// Returns zeros on pages that are not written yet. Fails if the array does not fit in memory.
fn zeros<T: Clone + Default>(len: usize) -> Result<Vec<T>, Refusal> {
    // The room is requested and freed again, because reserved zeros would be written.
    reserve(std::hint::black_box(&mut Vec::<T>::new()), len)?;
    Ok(vec![T::default(); len])
}

/// Calls `put` with the particles and the shift of each entry.
fn entries(contacts: &ContactList, half: bool, mut put: impl FnMut(u32, u32, [i32; 3])) {
    let mut both = |i, j, shift: [i32; 3]| {
        put(i, j, shift);
        if !half {
            put(j, i, shift.map(|s| -s));
        }
    };
    contacts.plain.iter().for_each(|&[i, j]| both(i, j, [0; 3]));
    contacts.shifted.iter().for_each(|it| both(it.i, it.j, it.image));
}

impl NeighbourList {
    fn new(
        particles: usize,
        contacts: &ContactList,
        wanted: Wanted,
        shifts: bool,
    ) -> Result<NeighbourList, Refusal> {
        let mut offsets: Vec<i64> = zeros(particles + 1)?;
        entries(contacts, wanted.half, |i, _, _| offsets[i as usize] += 1);
        let mut len = 0;
        for offset in &mut offsets {
            len += std::mem::replace(offset, len);
        }
        let len = len as usize;
        let mut list =
            NeighbourList { offsets, j: zeros(len)?, shifts: zeros(if shifts { len } else { 0 })? };
        entries(contacts, wanted.half, |i, j, shift| {
            let at = &mut list.offsets[i as usize];
            list.j[*at as usize] = i64::from(j);
            if shifts {
                list.shifts[*at as usize] = shift;
            }
            *at += 1;
        });
        // Each offset has moved to the end of its row, which is the start of the next row.
        list.offsets.rotate_right(1);
        list.offsets[0] = 0;
        if wanted.sorted {
            list.sort();
        }
        Ok(list)
    }

    /// Orders each row by j and shift.
    fn sort(&mut self) {
        let mut row = Vec::new();
        for ends in self.offsets.windows(2) {
            let range = ends[0] as usize..ends[1] as usize;
            row.clear();
            row.extend(range.clone().map(|k| (self.j[k], self.shift(k))));
            row.sort_unstable();
            for (k, &(j, shift)) in range.zip(&row) {
                self.j[k] = j;
                if let Some(of) = self.shifts.get_mut(k) {
                    *of = shift;
                }
            }
        }
    }

    fn shift(&self, k: usize) -> [i32; 3] {
        self.shifts.get(k).copied().unwrap_or_default()
    }

    /// Returns the first particle of each entry.
    fn i(&self) -> Result<Vec<i64>, Refusal> {
        let mut all = Vec::new();
        reserve(&mut all, self.j.len())?;
        for (i, ends) in self.offsets.windows(2).enumerate() {
            all.extend(std::iter::repeat_n(i as i64, (ends[1] - ends[0]) as usize));
        }
        Ok(all)
    }
}

/// Returns offsets (N + 1), i (M), j (M) and, if wanted, S (M, D), D (M, D) and d (M).
#[pyfunction]
pub fn neighbours(
    py: Python<'_>,
    search: &Bound<'_, Search>,
    x: PyReadonlyArrayDyn<'_, f64>,
    r: PyReadonlyArrayDyn<'_, f64>,
    edges: Option<Edges>,
    wanted: Wanted,
) -> PyResult<Lists> {
    let (own, find) = (search.get(), search.get().finding());
    let search = move |working: &mut _, arrays: &Arrays<'_>| {
        let (contacts, boxed, _) = find(working, arrays)?;
        let shifts = wanted.shifts || boxed.is_some() && (wanted.vectors || wanted.sorted);
        let table = NeighbourList::new(arrays.len(), &contacts, wanted, shifts)?;
        drop(contacts);
        let (i, dim) = (table.i()?, arrays.dim());
        let (mut vectors, mut distances) = (Vec::new(), Vec::new());
        if wanted.vectors {
            reserve(&mut vectors, i.len() * dim)?;
            reserve(&mut distances, i.len())?;
            for (k, (&i, &j)) in i.iter().zip(&table.j).enumerate() {
                let vector = arrays.vector(i as usize, j as usize, table.shift(k));
                vectors.extend(&vector[..dim]);
                let [x, y, z] = vector;
                let square = x * x + y * y + z * z;
                let fits = square.is_normal();
                distances.push(if fits { square.sqrt() } else { x.hypot(y).hypot(z) });
            }
        }
        Ok((i, dim, table, vectors, distances))
    };
    let (i, dim, NeighbourList { offsets, j, shifts }, vectors, distances) =
        own.with(py, Arrays::new(&x, &r, edges)?, search)?;
    let shifts = match dim {
        3 => shifts.into_flattened(),
        _ => shifts.iter().flat_map(|shift| &shift[..dim]).copied().collect(),
    };
    let [offsets, i, j] = [offsets, i, j].map(|all| all.into_pyarray(py).unbind());
    let shifts = wanted.shifts.then(|| rows(py, shifts, dim)).transpose()?;
    let with = wanted.vectors;
    let vectors = with.then(|| rows(py, vectors, dim)).transpose()?;
    Ok((offsets, i, j, shifts, vectors, with.then(|| distances.into_pyarray(py).unbind())))
}
