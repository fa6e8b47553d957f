//! A scene as a simulation has it: particles, and the box in which they repeat, if they do.

use anyhow::bail;

use crate::boxes::along;
use crate::{Notice, RadiusSource};
use contactbench_core::contact::Arithmetic;
use contactbench_core::periodic::Periodic;
use contactbench_core::scene::{AnyScene, Lattice};
use contactbench_core::searcher::{LoadError, Loaded};

/// A scene with its boundaries.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    pub scene: AnyScene<'static>,
    /// The box in which they repeat; none where boundaries are open.
    pub lattice: Option<Lattice>,
    /// The file that it was read from has a box, whether that repeats or not.
    pub has_box: bool,
    pub notices: Vec<Notice>,
    /// Where the file's radii come from; none of a scene that is made, which is not doubted.
    pub source: Option<RadiusSource>,
}

impl<S: Into<AnyScene<'static>>> From<S> for Given {
    fn from(scene: S) -> Given {
        Given {
            scene: scene.into(),
            lattice: None,
            has_box: false,
            notices: Vec::new(),
            source: None,
        }
    }
}

impl Given {
    /// The scene in its box; one that repeats along no axis is none.
    pub fn in_box(scene: AnyScene<'static>, lattice: Lattice) -> anyhow::Result<Given> {
        let (scene, lattice) = Periodic::new(scene, lattice)?.into_parts();
        Ok(Given { lattice: lattice.repeats().then_some(lattice), ..scene.into() })
    }

    /// The particles, for those who know no boxes; `name` is that of the scene.
    pub fn open(self, name: &str) -> anyhow::Result<AnyScene<'static>> {
        match self.lattice {
            None => Ok(self.scene),
            Some(lattice) => bail!(
                "{name}: the scene repeats along {}, and here boundaries are open; take it without \
                 its box",
                along(lattice.periodic())
            ),
        }
    }

    /// As the core takes it, if there is a box.
    pub fn periodic(&self) -> anyhow::Result<Option<Periodic<'static>>> {
        let periodic = |lattice: Lattice| Periodic::new(self.scene.clone(), lattice);
        Ok(self.lattice.map(periodic).transpose()?)
    }

    /// As detectors get it in an arithmetic.
    pub fn loaded(&self, arithmetic: Arithmetic) -> Result<Loaded<'static>, LoadError> {
        Loaded::new(&self.scene, self.lattice, arithmetic)
    }
}
