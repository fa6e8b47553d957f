//! Scenes of arrays, and arrays of contacts.

use std::borrow::Cow;

use contactbench_core::contact::Arithmetic;
use contactbench_core::periodic::Contacts;
use contactbench_core::scene::{AnyScene, Lattice, Radii, Scene, Storage, array, points};
use contactbench_core::sink::smaller_first;
use contactbench_core::with_scene;
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::failure::Failure;

/// Vectors, along which of them the scene repeats, and the corner.
pub type Edges = ([[f64; 3]; 3], [bool; 3], [f64; 3]);

/// Arrays of doubles, as they are in memory. Nobody may write to them meanwhile.
#[derive(Clone, Copy)]
pub struct Arrays<'a> {
    x: &'a [f64],
    dim: usize,
    r: &'a [f64],
    /// One radius is for all.
    one: bool,
    edges: Option<Edges>,
}

impl<'a> Arrays<'a> {
    /// Centres (N, 2) or (N, 3), and radii: a number, or N.
    pub fn new(
        x: &'a PyReadonlyArrayDyn<'_, f64>,
        r: &'a PyReadonlyArrayDyn<'_, f64>,
        edges: Option<Edges>,
    ) -> Result<Arrays<'a>, Failure> {
        let dim = match *x.shape() {
            [_, dim @ (2 | 3)] => dim,
            _ => {
                return Err(Failure::value(format!(
                    "x has the shape {:?}; centres are N rows of 2 or 3 numbers",
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
        let (x, one) = (x.as_slice().map_err(apart)?, r.shape().is_empty());
        Ok(Arrays { x, dim, r: r.as_slice().map_err(apart)?, one, edges })
    }

    /// How many particles there are.
    pub fn len(&self) -> usize {
        self.x.len() / self.dim
    }

    /// The scene: the same memory.
    pub fn scene(&self) -> Result<AnyScene<'a>, Failure> {
        let radii = match *self.r {
            [r] if self.one => Radii::Uniform(r),
            _ => Radii::Each(Cow::Borrowed(self.r)),
        };
        Ok(match self.dim {
            2 => Scene::new(points::<2>(self.x.as_chunks().0), radii)?.into(),
            _ => Scene::new(points::<3>(self.x.as_chunks().0), radii)?.into(),
        })
    }

    /// A copy that lasts.
    pub fn owned(&self) -> Result<AnyScene<'static>, Failure> {
        Ok(self.scene()?.stored(Storage::F64)?)
    }

    /// The box.
    pub fn lattice(&self) -> Result<Option<Lattice>, Failure> {
        let of = |(vectors, periodic, origin)| Lattice::new(vectors, periodic, origin);
        Ok(self.edges.map(of).transpose()?)
    }
}

/// An arithmetic by its name.
pub fn arithmetic(name: &str) -> Result<Arithmetic, Failure> {
    name.parse().map_err(Failure::value)
}

type Pairs = Py<PyArray2<u32>>;
type Images = Py<PyArray2<i32>>;

/// The pairs (M, 2), the smaller number first, and in a box the images (M, D).
pub fn answer(
    py: Python<'_>,
    contacts: Contacts,
    boxed: Option<usize>,
) -> PyResult<(Pairs, Option<Images>)> {
    let Contacts { plain: mut pairs, shifted } = contacts;
    let plain = pairs.len();
    let images = boxed.map(|dim| {
        let mut images = vec![0; (plain + shifted.len()) * dim];
        for (row, pair) in images[plain * dim..].chunks_mut(dim).zip(&shifted) {
            row.copy_from_slice(&pair.image[..dim]);
        }
        rows(py, images, dim)
    });
    pairs.extend(shifted.iter().map(|pair| [pair.i, pair.j]));
    pairs.shrink_to_fit();
    Ok((rows(py, pairs.into_flattened(), 2)?, images.transpose()?))
}

/// Brings the pairs into the form in which they are given; needs no Python.
pub fn tidy(contacts: &mut Contacts) {
    smaller_first(&mut contacts.plain);
}

/// Numbers as rows of an array, which takes their memory.
pub fn rows<T: numpy::Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    width: usize,
) -> PyResult<Py<PyArray2<T>>> {
    let len = numbers.len() / width;
    Ok(numbers.into_pyarray(py).reshape([len, width])?.unbind())
}

/// A scene as arrays: centres (N, D), N radii, and the radius of all, if there is one.
pub type Made = (Py<PyArray2<f64>>, Py<PyArray1<f64>>, Option<f64>);

/// The arrays of a scene.
pub fn made(py: Python<'_>, scene: &AnyScene<'_>) -> PyResult<Made> {
    let dim = scene.dim();
    let uniform = scene.uniform().then(|| scene.largest_radius());
    let (x, r) = with_scene!(scene, scene => {
        use contactbench_core::scene::Real;
        let wide = |p| array(p).map(Real::wide);
        let x: Vec<f64> = scene.centres().iter().flat_map(wide).collect();
        let r: Vec<f64> = (0..scene.len()).map(|k| scene.radius(k).wide()).collect();
        (x, r)
    });
    Ok((rows(py, x, dim)?, r.into_pyarray(py).unbind(), uniform))
}
