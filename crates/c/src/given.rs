//! Scenes and options from the caller, and the reasons for refusing scenes.

use std::any::Any;
use std::borrow::Cow;

use contactbench_detectors::oracle::NoTruth;
use contactbench_ground::limits::refusal::{Refusal, no_memory, panic_text};
use contactbench_ground::periodic::LoadError;
use contactbench_ground::scene::{
    AnyScene, Lattice, LatticeError, Radii, Scene, SceneError, points,
};

use crate::contactbench_scene;

/// The reason why a call failed, in one sentence.
pub enum Failure {
    /// An argument is invalid.
    Invalid(String),
    /// Memory, or its limit, is too small.
    Memory(String),
    /// A defect of this library.
    Defect(String),
}

impl Failure {
    pub fn invalid(what: impl ToString) -> Failure {
        Failure::Invalid(what.to_string())
    }

    /// Converts a panic, which is a defect of this library.
    pub fn defect(cause: &(dyn Any + Send)) -> Failure {
        if let Some(refusal) = no_memory(cause) {
            return refusal.into();
        }
        let said = panic_text(cause);
        if said.contains("changed during a detection") {
            return Failure::invalid("an array of the scene was written to during the call");
        }
        Failure::Defect(format!("{said}; this is a defect of contactbench: report it"))
    }
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Failure {
        match refusal.is_of_memory() {
            true => Failure::Memory(refusal.to_string()),
            false => Failure::invalid(refusal),
        }
    }
}

macro_rules! invalid {
    ($($error:ty),*) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Failure {
                Failure::invalid(error)
            }
        }
    )*};
}
invalid!(SceneError, LatticeError, LoadError);

impl From<NoTruth> for Failure {
    fn from(error: NoTruth) -> Failure {
        match error {
            NoTruth::Refused(refusal) => refusal.into(),
            NoTruth::Disagree { .. } | NoTruth::Sample { .. } => Failure::Defect(error.to_string()),
            _ => Failure::invalid(error),
        }
    }
}

/// A scene whose coordinates and radii stay in the caller's memory.
pub struct Given<'a> {
    pub scene: AnyScene<'a>,
    pub lattice: Option<Lattice>,
}

impl Given<'_> {
    /// # Safety
    /// `scene` is null, or points to a scene whose numbers can be read as long as this value lives.
    pub unsafe fn new(scene: *const contactbench_scene) -> Result<Self, Failure> {
        // SAFETY: promised by the caller.
        let Some(scene) = (unsafe { scene.as_ref() }) else {
            return Err(Failure::invalid("the scene is NULL"));
        };
        let dim @ (2 | 3) = scene.dim as usize else {
            let reason = format!("dim is {}; it is 2 for discs and 3 for spheres", scene.dim);
            return Err(Failure::Invalid(reason));
        };
        // SAFETY: promised by the caller.
        let x = unsafe { rows(scene.x, scene.n, dim, "x") }?;
        // SAFETY: promised by the caller.
        let r = unsafe { rows(scene.r, scene.radii, 1, "r") }?;
        let radii = match *r {
            [r] => Radii::Uniform(r),
            _ => Radii::Each(Cow::Borrowed(r)),
        };
        // SAFETY: promised by the caller.
        let lattice = match unsafe { scene.bounds.as_ref() } {
            Some(bounds) => {
                let vector = |k: usize| std::array::from_fn(|axis| bounds.vectors[3 * k + axis]);
                let mut periodic = bounds.periodic.map(|flag| flag != 0);
                // The third vector is ignored for discs.
                periodic[2] &= dim == 3;
                Some(Lattice::new([0, 1, 2].map(vector), periodic, bounds.origin)?)
            }
            None => None,
        };
        let scene = match dim {
            2 => Scene::new(points::<2>(x.as_chunks().0), radii)?.into(),
            _ => Scene::new(points::<3>(x.as_chunks().0), radii)?.into(),
        };
        Ok(Given { scene, lattice })
    }
}

/// Returns `count` rows of `width` numbers.
///
/// # Safety
/// The pointer is null, or `count` times `width` numbers can be read as long as they are used.
pub unsafe fn rows<'a, T>(
    numbers: *const T,
    count: usize,
    width: usize,
    name: &str,
) -> Result<&'a [T], Failure> {
    let most = isize::MAX as usize / size_of::<T>();
    let Some(len) = count.checked_mul(width).filter(|&len| len <= most) else {
        return Err(Failure::invalid(format!("{name}: {count} rows are more than memory holds")));
    };
    if len == 0 {
        return Ok(&[]);
    }
    if numbers.is_null() || !numbers.is_aligned() {
        return Err(Failure::invalid(format!("{name} is NULL, or not aligned")));
    }
    // SAFETY: the pointer is aligned and not null, and the length is valid; the caller promises
    // that the numbers can be read.
    Ok(unsafe { std::slice::from_raw_parts(numbers, len) })
}
