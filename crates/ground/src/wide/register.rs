//! One register of an instruction set, and sixteen lanes made of several registers.

use super::{HALF, Kernel, LANES, Slot, Spot, Wide};

/// One vector register. A value is the proof that its instructions may be used.
///
/// # Safety
/// A register of type `Floats` or `Ids` has [`Register::LANES`] numbers of 32 bits, `Pairs` as many
/// pairs of them, and `Many` has `16 / LANES` elements. [`Register::count`] returns the number of
/// set bits, and all results are initialised.
pub unsafe trait Register: Copy + Send + Sync {
    /// Number of floats in a register, 4, 8 or 16.
    const LANES: usize;
    /// Type of a register of floats, [`Register::LANES`] of them.
    type Floats: Copy;
    /// Type of a register of numbers, as many as floats.
    type Ids: Copy;
    /// Type of as many pairs of numbers as a register has floats.
    type Pairs: Copy;
    /// Type of an array with an element for each register of sixteen lanes.
    type Many<A: Copy>: Copy + AsRef<[A]> + AsMut<[A]>;

    /// Returns an array of equal elements.
    fn many<A: Copy>(a: A) -> Self::Many<A>;
    /// Returns a register with the same number in every lane.
    fn all(self, x: f32) -> Self::Floats;
    /// Returns a + b in each lane.
    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// Returns a - b in each lane.
    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// Returns a · b in each lane.
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// Returns a · b + c in each lane, rounded once or twice.
    fn mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats;
    /// Returns the larger of a and b in each lane, or b if a is NaN.
    fn max(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// Returns a mask of the lanes with a <= b.
    fn at_most(self, a: Self::Floats, b: Self::Floats) -> u32;
    /// Moves the ids that `mask` selects to the first lanes; the other lanes are unspecified.
    fn pack(self, ids: Self::Ids, mask: u32) -> Self::Ids;
    /// Returns the pair (i, id) for each of the ids.
    fn pair(self, i: u32, ids: Self::Ids) -> Self::Pairs;
    /// Runs a kernel compiled for these instructions.
    fn run<K: Kernel>(self, kernel: K) -> K::Output;

    /// Returns the number of lanes that `mask` selects.
    #[inline(always)]
    fn count(mask: u32) -> usize {
        // Processors with four lanes may lack an instruction that counts bits.
        let four = (0x4332_3221_3221_2110u64 >> (4 * (mask & 15)) & 7) as usize;
        if Self::LANES == 4 { four } else { mask.count_ones() as usize }
    }

    /// Returns the squared distances and the numbers of as many pairs of points as there are lanes,
    /// for [`Wide::squares`].
    #[inline(always)]
    fn squares(self, spots: &[Spot], pairs: &[[u32; 2]]) -> (Self::Floats, Self::Pairs) {
        let (mut squares, mut ids) = ([0.0; LANES], [[0; 2]; LANES]);
        for (k, pair) in pairs.iter().enumerate().take(Self::LANES) {
            let [a, b] = pair.map(|place| &spots[place as usize]);
            (squares[k], ids[k]) = (a.square(b), [a.id, b.id]);
        }
        // SAFETY: both arrays are as long as a register or longer.
        unsafe { (read(squares.as_ptr()), read(ids.as_ptr())) }
    }

    /// Writes the pairs that `mask` selects to the front of `to`, which is as long as a register.
    #[inline(always)]
    fn pack_pairs(self, pairs: Self::Pairs, mask: u32, to: &mut [[u32; 2]]) {
        let (pairs, mut packed): (*const Self::Pairs, _) = (&pairs, 0);
        // The loop has no branches, because the mask is unpredictable.
        for k in 0..Self::LANES {
            // SAFETY: there is a pair for each lane.
            to[packed % Self::LANES] = unsafe { *pairs.cast::<[u32; 2]>().add(k) };
            packed += (mask >> k & 1) as usize;
        }
    }
}

/// Reads a register, or an array of as many pairs as it has lanes.
///
/// # Safety
/// A value of type `V` must begin at `from`, in any alignment.
#[inline(always)]
pub unsafe fn read<A, V: Copy>(from: *const A) -> V {
    // SAFETY: the caller ensures that a `V` begins at `from`.
    unsafe { from.cast::<V>().read_unaligned() }
}

/// Returns the bits of the register that begins at lane `at`.
#[inline(always)]
fn lanes<R: Register>(mask: u32, at: usize) -> u32 {
    mask >> at & !(!0 << R::LANES)
}

/// Returns an array with a value for each register `$k` of sixteen lanes of registers `R`. A
/// function would take a closure. The compiler may leave a closure outside the code compiled for
/// the instruction set, and each of its instructions is then a call.
macro_rules! each {
    ($k:ident => $value:expr) => {{
        let $k = 0;
        let mut all = R::many($value);
        for $k in 1..LANES / R::LANES {
            all.as_mut()[$k] = $value;
        }
        all
    }};
}

impl<R: Register> Wide for R {
    type Register = R;
    type Floats = R::Many<R::Floats>;
    type Pairs = R::Many<R::Pairs>;

    #[inline(always)]
    fn register(self) -> R {
        self
    }

    #[inline(always)]
    fn all(self, x: f32) -> Self::Floats {
        R::many(self.all(x))
    }

    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> Self::Floats {
        // SAFETY: each register is part of the sixteen lanes.
        each!(k => unsafe { read(from.as_ptr().add(k * R::LANES)) })
    }

    #[inline(always)]
    fn load_two(self, low: &[f32; HALF], high: &[f32; HALF]) -> Self::Floats {
        let both = [*low, *high];
        // SAFETY: as for `load`.
        each!(k => unsafe { read(both.as_flattened().as_ptr().add(k * R::LANES)) })
    }

    #[inline(always)]
    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats {
        each!(k => self.add(a.as_ref()[k], b.as_ref()[k]))
    }

    #[inline(always)]
    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats {
        each!(k => self.sub(a.as_ref()[k], b.as_ref()[k]))
    }

    #[inline(always)]
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats {
        each!(k => self.mul(a.as_ref()[k], b.as_ref()[k]))
    }

    #[inline(always)]
    fn mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats {
        each!(k => self.mul_add(a.as_ref()[k], b.as_ref()[k], c.as_ref()[k]))
    }

    #[inline(always)]
    fn max(self, a: Self::Floats, b: Self::Floats) -> Self::Floats {
        each!(k => self.max(a.as_ref()[k], b.as_ref()[k]))
    }

    #[inline(always)]
    fn at_most(self, a: Self::Floats, b: Self::Floats) -> u32 {
        let mut mask = 0;
        for (k, (&a, &b)) in a.as_ref().iter().zip(b.as_ref()).enumerate() {
            mask |= self.at_most(a, b) << (k * R::LANES);
        }
        mask
    }

    #[inline(always)]
    fn pack_two(self, low: &[u32; HALF], high: &[u32; HALF], mask: u32, to: &mut [u32; HALF]) {
        let (from, mut both, mut packed) = ([*low, *high], [0; LANES], 0);
        for at in (0..LANES).step_by(R::LANES) {
            let mask = lanes::<R>(mask, at);
            // SAFETY: the register is part of the sixteen ids. At most `at` numbers precede, so a
            // register fits.
            unsafe {
                let ids = self.pack(read(from.as_flattened().as_ptr().add(at)), mask);
                both.as_mut_ptr().add(packed).cast::<R::Ids>().write_unaligned(ids);
            }
            packed += R::count(mask);
        }
        to.copy_from_slice(&both[..HALF]);
    }

    #[inline(always)]
    fn pair(self, i: u32, ids: &[u32; HALF], to: &mut [Slot; HALF]) {
        let (from, mut pairs) = ([*ids; 2], [Slot::uninit(); LANES]);
        for at in (0..HALF).step_by(R::LANES) {
            // SAFETY: a register has at most sixteen lanes, and both arrays have sixteen elements.
            unsafe {
                let ids = read(from.as_flattened().as_ptr().add(at));
                let to = pairs.as_mut_ptr().add(at).cast::<R::Pairs>();
                to.write_unaligned(self.pair(i, ids));
            }
        }
        to.copy_from_slice(&pairs[..HALF]);
    }

    #[inline(always)]
    fn pairs(self, i: u32, ids: &[u32; LANES], mask: u32, to: &mut [Slot; LANES]) {
        let mut packed = 0;
        for at in (0..LANES).step_by(R::LANES) {
            let mask = lanes::<R>(mask, at);
            // SAFETY: the register is part of the sixteen ids. At most `at` pairs precede, so as
            // many pairs as a register has lanes fit.
            unsafe {
                let ids = self.pack(read(ids.as_ptr().add(at)), mask);
                let to = to.as_mut_ptr().add(packed).cast::<R::Pairs>();
                to.write_unaligned(self.pair(i, ids));
            }
            packed += R::count(mask);
        }
    }

    #[inline(always)]
    fn load_pairs(self, from: &[[u32; 2]; LANES]) -> Self::Pairs {
        // SAFETY: each register's pairs are part of the sixteen pairs.
        each!(k => unsafe { read(from.as_ptr().add(k * R::LANES)) })
    }

    #[inline(always)]
    fn squares(self, spots: &[Spot], pairs: &[[u32; 2]; LANES]) -> (Self::Floats, Self::Pairs) {
        let both = each!(k => self.squares(spots, &pairs[k * R::LANES..][..R::LANES]));
        (each!(k => both.as_ref()[k].0), each!(k => both.as_ref()[k].1))
    }

    #[inline(always)]
    fn pack_pairs(self, pairs: Self::Pairs, mask: u32, to: &mut [[u32; 2]; LANES]) {
        let mut packed = 0;
        for (k, &pairs) in pairs.as_ref().iter().enumerate() {
            let mask = lanes::<R>(mask, k * R::LANES);
            self.pack_pairs(pairs, mask, &mut to[packed..][..R::LANES]);
            packed += R::count(mask);
        }
    }

    #[inline(always)]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        self.run(kernel)
    }
}

/// Implements methods of [`Register`] that are few instructions each.
macro_rules! instructions {
    ($($name:ident($($arg:ident: $type:ty),*) -> $result:ty = $value:expr;)*) => {$(
        #[inline(always)]
        #[allow(unused_unsafe, reason = "plain Rust is safe")]
        fn $name(self, $($arg: $type),*) -> $result {
            // SAFETY: the value proves that its instructions were found. Reads are of whole arrays.
            unsafe { $value }
        }
    )*};
}
pub(super) use instructions;
