//! Decides listed pairs in a frame and collects contacts, in open space or in a box.

use super::around::Around;
use contactbench_ground::contact::Test;
use contactbench_ground::pairs::pair_list::PairList;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::periodic::{ImagePair, List};
use contactbench_ground::scene::Scene;
use contactbench_ground::wide::Spot;

pub(super) trait PairReceiver {
    /// Whether pairs are numbered by places or by the scene's particle numbers.
    const BY_PLACE: bool;

    /// Receives pairs that certainly touch.
    fn take(&mut self, pairs: &[[u32; 2]]);

    /// Tests a pair that the filter leaves open, and keeps the pair if it touches.
    fn decide(&mut self, pair: [u32; 2]);
}

pub(super) struct Open<'a, 'p, F> {
    pub touch: F,
    pub pairs: &'a mut PairList<'p>,
}

impl<F: FnMut(u32, u32) -> bool> PairReceiver for Open<'_, '_, F> {
    const BY_PLACE: bool = false;

    #[inline(always)]
    fn take(&mut self, pairs: &[[u32; 2]]) {
        self.pairs.contacts(pairs);
    }

    fn decide(&mut self, [i, j]: [u32; 2]) {
        if (self.touch)(i, j) {
            self.pairs.contact(i, j);
        }
    }
}

pub(super) struct Boxed<'a, 'p, const D: usize> {
    pub scene: &'a Scene<'a, f64, D>,
    pub test: Test,
    pub spots: &'a [Spot],
    pub around: &'a Around<D>,
    pub plain: &'a mut PairList<'p>,
    pub shifted: &'a mut List,
    /// Number of pairs that exact arithmetic decided.
    pub exact: u64,
}

impl<const D: usize> Boxed<'_, '_, D> {
    /// Tests a pair of a particle and an image, and keeps the pair if it touches.
    pub fn decide_image(&mut self, ImagePair { i: a, j: b, image }: ImagePair) {
        let image = self.around.image(a, b, image);
        let (i, j) = (self.particle(a), self.particle(b));
        let (touch, exact) = self.around.touch(self.scene, [i, j], image, self.test);
        self.exact += u64::from(exact);
        if touch {
            self.put(i, j, image);
        }
    }

    fn particle(&self, place: u32) -> u32 {
        self.spots[place as usize].id
    }

    fn put(&mut self, i: u32, j: u32, image: [i32; 3]) {
        match image {
            [0, 0, 0] => self.plain.contact(i, j),
            image => self.shifted.push(ImagePair::new(i, j, image)),
        }
    }
}

impl<const D: usize> PairReceiver for Boxed<'_, '_, D> {
    const BY_PLACE: bool = true;

    fn take(&mut self, pairs: &[[u32; 2]]) {
        for &[a, b] in pairs {
            self.put(self.particle(a), self.particle(b), self.around.image(a, b, [0; 3]));
        }
    }

    fn decide(&mut self, [i, j]: [u32; 2]) {
        self.decide_image(ImagePair { i, j, image: [0; 3] });
    }
}
