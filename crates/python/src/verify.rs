//! Comparison of pair lists with the truth.

use contactbench_detectors::oracle::{Causes, Errors};
use contactbench_ground::limits::memory::limit_for;
use contactbench_ground::periodic::{ContactList, ImagePair, Periodic};
use contactbench_ground::scene::Lattice;
use contactbench_run::verify::{
    Allowed, Job, Listed, Naming, Reading, Terms, Verification, causes,
};
use contactbench_scenes::Given;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::{Failure, patient, pool};
use crate::given::{Arrays, Edges, arithmetic, copied, rows};

/// Pairs, their images in a box, and their depths in mean radii.
type Worst = (Py<PyArray2<u32>>, Option<Py<PyArray2<i32>>>, Py<PyArray1<f64>>);

/// Compares a list of pairs with the truth. Returns a dictionary with the fields of the Python
/// class `Verification`.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn verify<'py>(
    py: Python<'py>,
    x: PyReadonlyArrayDyn<'_, f64>,
    r: PyReadonlyArrayDyn<'_, f64>,
    pairs: PyReadonlyArray2<'_, i64>,
    images: Option<PyReadonlyArray2<'_, i32>>,
    edges: Option<Edges>,
    arithmetic: &str,
    base: i64,
    both_sides: bool,
    skin: f64,
    most: usize,
    threads: usize,
    memory_limit: Option<u64>,
) -> PyResult<Bound<'py, PyDict>> {
    let arrays = Arrays::new(&x, &r, edges)?;
    let apart = |_| Failure::value("an array is not contiguous; give a copy of it");
    let list = pairs.as_slice().map_err(apart)?.as_chunks::<2>().0;
    let padded = |images: &PyReadonlyArray2<'_, i32>| -> Result<Vec<_>, Failure> {
        let three = |row: &[i32]| std::array::from_fn(|k| row.get(k).copied().unwrap_or(0));
        let rows = images.as_slice().map_err(apart)?.chunks(images.as_array().ncols().max(1));
        Ok(rows.map(three).collect())
    };
    let images: Option<Vec<[i32; 3]>> = images.as_ref().map(padded).transpose()?;
    let arithmetic = self::arithmetic(arithmetic)?;
    if !(skin >= 0.0 && skin.is_finite()) {
        let reason = format!("skin is {skin}; it must be a length of at least 0");
        return Err(Failure::value(reason).into());
    }
    let terms = Terms {
        arithmetic,
        allowed: Allowed { both_sides, skin },
        memory_limit: memory_limit.unwrap_or_else(|| limit_for(arrays.len())),
        kept: most,
        without: None,
    };
    let boxed = arrays.lattice()?.is_some().then_some(arrays.dim());
    let count = list.len();
    let compare = move |arrays: Arrays<'_>, list: &[[i64; 2]]| {
        let listed = Listed { pairs: list, images: images.as_deref() };
        pool(threads)?.install(|| compared(&arrays, listed, base, terms))
    };
    let (arrays, list) = py.detach(|| Ok::<_, Failure>((arrays.copied()?, copied(list)?)))?;
    let outcome = patient(py, move |_| compare(arrays, &list))?;
    report(py, count, boxed, outcome)
}

type Outcome = (Verification, Option<Reading>, Option<Causes>);

fn report(
    py: Python<'_>,
    listed: usize,
    boxed: Option<usize>,
    (found, reading, causes): Outcome,
) -> PyResult<Bound<'_, PyDict>> {
    let errors = |errors: &Errors| -> PyResult<_> {
        Ok(dict!(py, errors =>
            missed, spurious, duplicate, self_pairs, deepest_miss, widest_false))
    };
    let by_cause = |causes: &Causes| -> PyResult<_> {
        Ok(dict!(py;
            representation: errors(&causes.representation)?,
            predicate: errors(&causes.predicate)?,
            search: errors(&causes.search)?,
        ))
    };
    Ok(dict!(py;
        same: found.is_same(),
        contacts: found.truth.len(),
        listed: listed,
        errors: errors(&found.errors)?,
        missed: worst(py, &found.missed, boxed)?,
        spurious: worst(py, &found.spurious, boxed)?,
        unknown: rows(py, found.unknown.into_flattened(), 2)?,
        one_sided: rows(py, found.one_sided.into_flattened(), 2)?,
        within_skin: found.within_skin,
        hint: reading.as_ref().map(Reading::sentence),
        causes: causes.as_ref().map(by_cause).transpose()?,
    ))
}

/// Compares a list with the truth in an arithmetic. Also returns other possible meanings of the
/// list and, if the arithmetic rounds, the errors by cause.
fn compared(
    arrays: &Arrays<'_>,
    list: Listed<'_>,
    base: i64,
    terms: Terms,
) -> Result<Outcome, Failure> {
    let naming = Naming::Base(base);
    let others = [Naming::Base(1 - base.clamp(0, 1))];
    let (scene, lattice) = (arrays.scene()?, arrays.lattice()?);
    let space = Periodic::new(scene, lattice.unwrap_or(Lattice::OPEN)).map_err(Failure::value)?;
    let job = Job { space: &space, list, naming: &naming, others: &others, terms };
    let found = contactbench_run::verify::verify(&job)?;
    let reading = contactbench_run::verify::explain(&job, &found)?;
    // Only rounded arithmetics have causes. They need a list that identifies its contacts: without
    // allowed deviations, and with images if there is a box.
    if terms.arithmetic == Default::default()
        || terms.allowed != Allowed::default()
        || lattice.is_some() && list.images.is_none()
    {
        return Ok((found, reading, None));
    }
    let given = match lattice {
        Some(lattice) => Given::in_box(arrays.owned()?, lattice)?,
        None => arrays.owned()?.into(),
    };
    let causes =
        causes(&given, &contacts(list, base, arrays.len()), terms.arithmetic, terms.memory_limit)?;
    Ok((found, reading, causes))
}

/// Converts the pairs whose particle numbers exist.
fn contacts(list: Listed<'_>, base: i64, n: usize) -> ContactList {
    let mut contacts = ContactList::default();
    let place = |name: i64| {
        let place = name.checked_sub(base).and_then(|place| u32::try_from(place).ok());
        place.filter(|&place| (place as usize) < n)
    };
    for (k, &[i, j]) in list.pairs.iter().enumerate() {
        let (Some(i), Some(j)) = (place(i), place(j)) else { continue };
        match list.images.map_or([0; 3], |images| images[k]) {
            [0, 0, 0] => contacts.plain.push([i, j]),
            image => contacts.shifted.push(ImagePair::new(i, j, image)),
        }
    }
    contacts
}

fn worst(py: Python<'_>, list: &[(ImagePair, f64)], boxed: Option<usize>) -> PyResult<Worst> {
    let pairs = list.iter().flat_map(|(pair, _)| [pair.i, pair.j]).collect();
    let depths: Vec<f64> = list.iter().map(|(_, depth)| *depth).collect();
    let images = boxed.map(|dim| {
        let images = list.iter().flat_map(|(pair, _)| pair.image[..dim].to_vec()).collect();
        rows(py, images, dim)
    });
    Ok((rows(py, pairs, 2)?, images.transpose()?, depths.into_pyarray(py).unbind()))
}
