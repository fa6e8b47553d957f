//! Scenes from NumPy arrays, and arrays of contacts.

use std::borrow::Cow;

use contactbench_ground::contact::Arithmetic;
use contactbench_ground::limits::refusal::reserve;
use contactbench_ground::periodic::ContactList;
use contactbench_ground::scene::{AnyScene, Lattice, Radii, Scene, Storage, array, points};
use contactbench_ground::with_scene;
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::failure::Failure;

/// Vectors, periodic flags and corner of a box.
pub type Edges = ([[f64; 3]; 3], [bool; 3], [f64; 3]);

/// Arrays of a scene. While they are borrowed, no thread may write to them.
pub struct Arrays<'a> {
    x: Cow<'a, [f64]>,
    dim: usize,
    r: Cow<'a, [f64]>,
    edges: Option<Edges>,
}

impl<'a> Arrays<'a> {
    /// Checks and borrows centres (N, 2) or (N, 3), and one radius or N radii.
    pub fn new(
        x: &'a PyReadonlyArrayDyn<'_, f64>,
        r: &'a PyReadonlyArrayDyn<'_, f64>,
        edges: Option<Edges>,
    ) -> Result<Arrays<'a>, Failure> {
        let dim = match *x.shape() {
            [_, dim @ (2 | 3)] => dim,
            _ => {
                let turned = if matches!(x.shape(), [2 | 3, _]) { "; give x.T" } else { "" };
                return Err(Failure::value(format!(
                    "x has the shape {:?}; centres are N rows of 2 or 3 numbers{turned}",
                    x.shape()
                )));
            }
        };
        if r.shape().len() > 1 {
            return Err(Failure::value(format!(
                "r has the shape {:?}; give one radius for all particles, or N",
                r.shape()
            )));
        }
        let apart = |_| Failure::value("an array is not contiguous; give a copy of it");
        let (x, r) = (x.as_slice().map_err(apart)?, r.as_slice().map_err(apart)?);
        Ok(Arrays { x: x.into(), dim, r: r.into(), edges })
    }

    pub fn len(&self) -> usize {
        self.x.len() / self.dim
    }

    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Returns the vector from particle i to the image of j, computed in f64.
    pub fn vector(&self, i: usize, j: usize, shift: [i32; 3]) -> [f64; 3] {
        let mut vector = [0.0; 3];
        for (k, of) in vector.iter_mut().take(self.dim).enumerate() {
            *of = self.x[j * self.dim + k] - self.x[i * self.dim + k];
            if let Some((vectors, ..)) = self.edges {
                *of += (0..3).map(|v| f64::from(shift[v]) * vectors[v][k]).sum::<f64>();
            }
        }
        vector
    }

    /// Returns the scene without a copy.
    pub fn scene(&self) -> Result<AnyScene<'_>, Failure> {
        let radii = match self.r[..] {
            [r] => Radii::Uniform(r),
            _ => Radii::Each(Cow::Borrowed(&*self.r)),
        };
        Ok(match self.dim {
            2 => Scene::new(points::<2>(self.x.as_chunks().0), radii)?.into(),
            _ => Scene::new(points::<3>(self.x.as_chunks().0), radii)?.into(),
        })
    }

    pub fn owned(&self) -> Result<AnyScene<'static>, Failure> {
        Ok(self.scene()?.stored(Storage::F64)?)
    }

    /// Copies the arrays, so that the caller may change its own while work continues after the
    /// call.
    pub fn copied(&self) -> Result<Arrays<'static>, Failure> {
        let (x, r) = (copied(&self.x)?.into(), copied(&self.r)?.into());
        Ok(Arrays { x, dim: self.dim, r, edges: self.edges })
    }

    /// Returns whether a detection may take so long that a user interrupts it. The slowest detector
    /// takes some ms for 2,000 particles, or for as many pairs of particles and images in a box.
    pub fn are_many(&self) -> bool {
        // A box that is refused takes no time.
        let Ok(lattice) = self.lattice() else { return false };
        let reach = self.r.iter().fold(0.0, |most: f64, &r| most.max(2.0 * r));
        let images = |v| lattice.map_or(1.0, |lattice| 1.0 + 2.0 * reach / lattice.height(v));
        let n = self.len() as f64;
        n * n.max(200.0) * (0..3).map(images).product::<f64>() > 4e6
    }

    pub fn lattice(&self) -> Result<Option<Lattice>, Failure> {
        let of = |(vectors, periodic, origin)| Lattice::new(vectors, periodic, origin);
        self.edges.map(of).transpose().map_err(Failure::value)
    }
}

pub fn copied<T: Copy>(numbers: &[T]) -> Result<Vec<T>, Failure> {
    let mut copy = Vec::new();
    reserve(&mut copy, numbers.len())?;
    copy.extend_from_slice(numbers);
    Ok(copy)
}

pub fn arithmetic(name: &str) -> Result<Arithmetic, Failure> {
    name.parse().map_err(Failure::value)
}

/// The pairs (M, 2), with the smaller number first, and in a box the images (M, D).
pub type Answer = (Py<PyArray2<u32>>, Option<Py<PyArray2<i32>>>);

pub fn answer(py: Python<'_>, mut contacts: ContactList, boxed: Option<usize>) -> PyResult<Answer> {
    let mut images = Vec::new();
    contacts.flatten(boxed.unwrap_or(0), &mut images).map_err(Failure::from)?;
    let images = boxed.map(|dim| rows(py, images, dim)).transpose()?;
    let mut pairs = contacts.plain;
    pairs.shrink_to_fit();
    Ok((rows(py, pairs.into_flattened(), 2)?, images))
}

/// Turns a list of numbers into rows of an array, without a copy.
pub fn rows<T: numpy::Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    width: usize,
) -> PyResult<Py<PyArray2<T>>> {
    let len = numbers.len() / width;
    Ok(numbers.into_pyarray(py).reshape([len, width])?.unbind())
}

/// A scene as arrays: centres (N, D), N radii, and the radius of all particles if it is the same.
pub type Made = (Py<PyArray2<f64>>, Py<PyArray1<f64>>, Option<f64>);

pub fn made(py: Python<'_>, scene: &AnyScene<'_>) -> PyResult<Made> {
    let dim = scene.dim();
    let uniform = scene.uniform().then(|| scene.largest_radius());
    let (x, r) = with_scene!(scene, scene => {
        use contactbench_ground::scene::Real;
        let wide = |p| array(p).map(Real::wide);
        let x: Vec<f64> = scene.centres().iter().flat_map(wide).collect();
        let r: Vec<f64> = (0..scene.len()).map(|k| scene.radius(k).wide()).collect();
        (x, r)
    });
    Ok((rows(py, x, dim)?, r.into_pyarray(py).unbind(), uniform))
}
