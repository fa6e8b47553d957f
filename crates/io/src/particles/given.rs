use anyhow::bail;

use crate::boxes::along;
use crate::types::{Notice, RadiusSource};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::periodic::Periodic;
use contactbench_ground::periodic::{LoadError, Loaded};
use contactbench_ground::scene::{AnyScene, Lattice};

#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    pub scene: AnyScene<'static>,
    /// The periodic box; `None` in open space.
    pub lattice: Option<Lattice>,
    /// Whether the file has a box, periodic or not.
    pub has_box: bool,
    pub notices: Vec<Notice>,
    /// Source of the radii in the file; `None` for a generated scene.
    pub source: Option<RadiusSource>,
}

impl<S: Into<AnyScene<'static>>> From<S> for Given {
    fn from(scene: S) -> Given {
        let (scene, notices) = (scene.into(), Vec::new());
        Given { scene, lattice: None, has_box: false, notices, source: None }
    }
}

impl Given {
    /// Puts a scene into its box. A box without periodic axes counts as open space.
    pub fn in_box(scene: AnyScene<'static>, lattice: Lattice) -> anyhow::Result<Given> {
        let (scene, lattice) = Periodic::new(scene, lattice)?.into_parts();
        Ok(Given { lattice: lattice.repeats().then_some(lattice), ..scene.into() })
    }

    pub fn open(self, name: &str) -> anyhow::Result<AnyScene<'static>> {
        match self.lattice {
            None => Ok(self.scene),
            Some(lattice) => bail!(
                "{name}: it repeats along {}; leave out its box: --open",
                along(lattice.periodic())
            ),
        }
    }

    pub fn periodic(&self) -> anyhow::Result<Option<Periodic<'static>>> {
        let periodic = |lattice: Lattice| Periodic::new(self.scene.clone(), lattice);
        Ok(self.lattice.map(periodic).transpose()?)
    }

    pub fn loaded(&self, arithmetic: Arithmetic) -> Result<Loaded<'static>, LoadError> {
        Loaded::new(&self.scene, self.lattice, arithmetic)
    }
}
