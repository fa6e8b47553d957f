//! Statistics of a motion.

use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_terms::moved::Moved;

use super::displacement::displacements;

#[derive(Default)]
pub struct Survey {
    pub moved: Moved,
    last: Option<Periodic<'static>>,
    /// Particles of each contact of the previous frame. Images are left out, because they change
    /// where a particle crosses a face.
    contacts: Vec<[u32; 2]>,
}

impl Survey {
    /// Adds a frame, with its contacts in ascending order.
    pub fn take(&mut self, frame: &Periodic<'static>, contacts: &[ImagePair]) {
        let contacts: Vec<_> = contacts.iter().map(|pair| [pair.i, pair.j]).collect();
        let moved = &mut self.moved;
        moved.frames += 1;
        moved.particles = frame.scene().len() as u64;
        moved.contacts += contacts.len() as u64;
        let before = std::mem::replace(&mut self.contacts, contacts);
        let Some(last) = self.last.replace(frame.clone()) else { return };
        let Some(displacements) = displacements(&last, frame) else { return };
        let stay = common(&before, &self.contacts);
        moved.born += self.contacts.len() as u64 - stay;
        moved.ended += before.len() as u64 - stay;
        moved.displacements.at_rest += displacements.iter().filter(|&&it| it == 0.0).count() as u64;
        let diameter = 2.0 * frame.scene().largest_radius();
        if diameter > 0.0 {
            let longest = displacements.iter().fold(0.0f64, |most, &step| most.max(step));
            moved.displacements.sum += displacements.iter().sum::<f64>() / diameter;
            moved.displacements.longest = moved.displacements.longest.max(longest / diameter);
        }
    }
}

/// Returns the number of pairs that both lists contain; the lists must be in ascending order.
fn common(a: &[[u32; 2]], b: &[[u32; 2]]) -> u64 {
    let mut b = b.iter().peekable();
    let is_there = |pair: &&[u32; 2]| {
        while b.next_if(|other| other < pair).is_some() {}
        b.next_if_eq(pair).is_some()
    };
    a.iter().filter(is_there).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_ground::periodic::without_shift;
    use contactbench_ground::scene::AnyScene;
    use contactbench_scenes::touching::in_open_space;

    #[test]
    fn contacts_begin_and_end() {
        let mut survey = Survey::default();
        let mut take = |places: [f64; 4], pairs: &[[u32; 2]]| {
            let scene = AnyScene::at(places.map(|x| [x, 0.0]), 1.0).unwrap();
            let contacts: Vec<ImagePair> = without_shift(pairs).collect();
            survey.take(&in_open_space(&scene).unwrap(), &contacts);
            survey.moved.clone()
        };
        let moved = take([0.0, 2.0, 5.0, 20.0], &[[0, 1]]);
        assert_eq!((moved.frames, moved.contacts, moved.born, moved.steps()), (1, 1, 0, 0));
        let moved = take([0.0, 2.5, 4.5, 20.0], &[[1, 2]]);
        assert_eq!([moved.born, moved.ended], [1, 1]);
        assert_eq!((moved.displacements.at_rest, moved.steps()), (2, 1));
        assert!((moved.displacements.longest - 0.25).abs() < 1e-12, "of a diameter of 2");
        assert!((moved.mean_way() - 0.125).abs() < 1e-12);
    }
}
