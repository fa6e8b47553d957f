//! Columns that show that the particles are not single spheres.

use crate::particles::Particles;
use crate::raw::lines::{number, short};
use crate::types::{Notice, assumed};

/// A column with the clump of each sphere.
#[derive(Clone, Debug, PartialEq)]
pub struct Clump {
    pub column: usize,
    pub name: String,
    /// Whether a sphere is in a clump; YADE writes -1 for one that is not.
    pub is_used: bool,
}

impl Clump {
    pub fn of(names: &[String]) -> Option<Clump> {
        let is_clump = |name: &String| name.to_ascii_lowercase().starts_with("clump");
        let column = names.iter().position(is_clump)?;
        Some(Clump { column, name: short(&names[column]), is_used: false })
    }

    pub fn see(&mut self, cell: &[u8]) {
        self.is_used |= number(cell).is_none_or(|value| value >= 0.0);
    }
}

/// Returns what unused columns say about the particles.
pub fn notices(particles: &Particles) -> Vec<Notice> {
    let unused = &particles.unused;
    let named = |fits: &dyn Fn(&str) -> bool| {
        unused.iter().find(|name| fits(&name.to_ascii_lowercase())).map(|name| short(name))
    };
    let has = |wanted: &str| unused.iter().any(|name| name.eq_ignore_ascii_case(wanted));
    let half_axes = ["a", "b", "c"].into_iter().all(has);
    let shape = named(&|name: &str| {
        ["shape", "blockiness", "aspherical"].iter().any(|it| name.starts_with(it))
            || half_axes && ["q0", "qw", "quat"].iter().any(|it| name.starts_with(it))
    });
    let shape = shape.map(|name| {
        assumed!(
            "the particles have shapes ({name}) and may be no spheres: they are read as spheres of \
             their radius or diameter"
        )
    });
    let clump = particles.clump.iter().filter(|it| it.is_used && particles.groups.is_none());
    let clump = clump.map(|Clump { name, .. }| {
        assumed!(
            "'{name}' may join spheres to clumps: contacts within a clump count as contacts; \
             verify --without {name}=same leaves them out"
        )
    });
    shape.into_iter().chain(clump).collect()
}
