//! Lists of the contacts of a periodic scene.

use super::{IMAGE_PAIR_BYTES, ImagePair, without_shift};
use crate::limits::refusal::{Refusal, reserve};
use crate::pairs::pair_list::{Allowance, PairList};
use crate::pairs::{normalise::normalise, sink::Digest};

/// The contacts of a periodic scene, in two lists.
#[derive(Clone, Debug, Default)]
pub struct ContactList {
    /// ContactList without a shift: S = 0.
    pub plain: Vec<[u32; 2]>,
    /// ContactList through a face of the box: S is not 0.
    pub shifted: Vec<ImagePair>,
}

impl ContactList {
    /// Removes all contacts and keeps the memory.
    pub fn clear(&mut self) {
        self.plain.clear();
        self.shifted.clear();
    }

    /// Returns the number of contacts.
    pub fn len(&self) -> u64 {
        self.plain.len() as u64 + self.shifted.len() as u64
    }

    /// Returns whether both lists are empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the number and fingerprint of the contacts.
    pub fn digest(&self) -> Digest {
        let mut digest = Digest::from_pairs(&self.plain);
        self.shifted.iter().for_each(|&ImagePair { i, j, image }| digest.image(i, j, image));
        digest
    }

    /// Returns all contacts in ascending order, in a list of at most `limit` bytes. `particles` is
    /// the scene's number of particles, for the error message.
    ///
    /// # Errors
    /// Returns [`Refusal::Pairs`] if the list would be longer, and [`Refusal::Exhausted`] if memory
    /// runs out.
    pub fn sorted(&self, particles: usize, limit: u64) -> Result<Vec<ImagePair>, Refusal> {
        let (found, mut pairs) = (self.len(), Vec::new());
        if found > limit / IMAGE_PAIR_BYTES {
            return Err(Refusal::Pairs { found, particles: particles as u64, room: limit });
        }
        // The result and the two lists are in memory at the same time.
        reserve(&mut pairs, self.plain.len() + self.shifted.len())?;
        pairs.extend(without_shift(&self.plain).chain(self.shifted.iter().copied()));
        pairs.sort_unstable();
        Ok(pairs)
    }

    /// Moves all contacts to `plain`, and appends `dim` numbers per contact to `images`.
    ///
    /// # Errors
    /// Returns [`Refusal::Exhausted`] if memory runs out.
    pub fn flatten(&mut self, dim: usize, images: &mut Vec<i32>) -> Result<(), Refusal> {
        let ContactList { plain, shifted } = self;
        reserve(images, (plain.len() + shifted.len()) * dim)?;
        reserve(plain, shifted.len())?;
        images.resize(images.len() + plain.len() * dim, 0);
        images.extend(shifted.iter().flat_map(|pair| &pair.image[..dim]));
        plain.extend(shifted.drain(..).map(|pair| [pair.i, pair.j]));
        Ok(())
    }

    /// Sorts both lists in place, with the smaller particle of each pair first.
    pub fn sort(&mut self) {
        normalise(&mut self.plain);
        self.shifted.sort_unstable();
    }

    /// Returns the contacts that `keep` accepts, in unchanged order.
    pub fn filtered(&self, keep: impl Fn(ImagePair) -> bool) -> ContactList {
        self.iter().filter(|&pair| keep(pair)).collect()
    }

    /// Iterates over all contacts, those without a shift first.
    pub fn iter(&self) -> impl Iterator<Item = ImagePair> + '_ {
        without_shift(&self.plain).chain(self.shifted.iter().copied())
    }

    /// Iterates over the contacts of the pair i <= j, given as `pair`. Both lists must be sorted.
    pub fn of(&self, pair: [u32; 2]) -> impl Iterator<Item = ImagePair> + '_ {
        let plain = self.plain.binary_search(&pair).is_ok().then_some(pair);
        let from = self.shifted.partition_point(|it| [it.i, it.j] < pair);
        let shifted = self.shifted[from..].iter().take_while(move |it| [it.i, it.j] == pair);
        let plain = plain.map(|[i, j]| ImagePair::new(i, j, [0; 3]));
        plain.into_iter().chain(shifted.copied())
    }

    /// Appends the contacts that `find` puts into lists of at most `limit` bytes each. `particles`
    /// is the scene's number of particles, for the error message. Fails with [`Refusal::Pairs`] if
    /// the lists would be longer; no contacts are appended then.
    pub fn gather<R>(
        &mut self,
        limit: u64,
        particles: usize,
        find: impl FnOnce(&mut PairList<'_>, &mut List) -> R,
    ) -> Result<R, Refusal> {
        let allowance = Allowance::new(limit);
        let mut plain = PairList::behind(std::mem::take(&mut self.plain), &allowance);
        let mut shifted = List::behind(std::mem::take(&mut self.shifted), limit);
        let found = find(&mut plain, &mut shifted);
        self.end(plain, shifted, particles, Ok(()))?;
        Ok(found)
    }

    /// Stores lists that continue this value's lists; drops the additions after an error.
    pub fn end(
        &mut self,
        plain: PairList<'_>,
        shifted: List,
        particles: usize,
        result: Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        let (before, found) = ([plain.before(), shifted.before], plain.found() + shifted.found);
        let all = plain.end(particles, &mut self.plain);
        let complete = all.is_ok() && shifted.is_complete();
        let room = if let Err(Refusal::Pairs { room, .. }) = all { room } else { shifted.limit };
        self.shifted = shifted.pairs;
        let listed = match all {
            _ if complete => Ok(()),
            Err(exhausted @ Refusal::Exhausted { .. }) => Err(exhausted),
            _ => Err(Refusal::Pairs { found, particles: particles as u64, room }),
        };
        let result = result.and(listed);
        if result.is_err() {
            self.plain.truncate(before[0]);
            self.shifted.truncate(before[1]);
        }
        result
    }
}

/// Splits a sorted list into two sorted lists: contacts without and with a shift.
impl FromIterator<ImagePair> for ContactList {
    fn from_iter<I: IntoIterator<Item = ImagePair>>(pairs: I) -> ContactList {
        let mut contacts = ContactList::default();
        for pair in pairs {
            match pair.image {
                [0, 0, 0] => contacts.plain.push([pair.i, pair.j]),
                _ => contacts.shifted.push(pair),
            }
        }
        contacts
    }
}

/// A list of contacts that stops growing at a limit. Further contacts are only counted.
pub struct List {
    pairs: Vec<ImagePair>,
    /// Number of contacts that were in the list at the start.
    before: usize,
    found: u64,
    /// Largest size of the list, in bytes.
    limit: u64,
}

impl List {
    /// Creates an empty list of at most this many bytes.
    pub fn new(limit: u64) -> List {
        List::behind(Vec::new(), limit)
    }

    /// Creates a list that begins with `pairs` and may grow to `limit` bytes.
    pub fn behind(pairs: Vec<ImagePair>, limit: u64) -> List {
        List { before: pairs.len(), pairs, found: 0, limit }
    }

    /// Returns the number of contacts found, including contacts that were not stored.
    pub fn found(&self) -> u64 {
        self.found
    }

    fn is_complete(&self) -> bool {
        self.found == (self.pairs.len() - self.before) as u64
    }

    /// Appends a contact, or only counts it if the list is full.
    #[inline]
    pub fn push(&mut self, pair: ImagePair) {
        let full = self.pairs.len() == self.pairs.capacity();
        let room = self.is_complete() && (!full || self.grow());
        self.found += 1;
        if room {
            self.pairs.push(pair);
        }
    }

    /// Appends the contacts that `of` makes of these pairs, as [`List::push`] does.
    pub fn append(&mut self, pairs: &[[u32; 2]], of: impl Fn([u32; 2]) -> ImagePair) {
        if self.is_complete() && pairs.len() <= self.pairs.capacity() - self.pairs.len() {
            self.found += pairs.len() as u64;
            self.pairs.extend(pairs.iter().map(|&pair| of(pair)));
        } else {
            pairs.iter().for_each(|&pair| self.push(of(pair)));
        }
    }

    #[cold]
    fn grow(&mut self) -> bool {
        let most = usize::try_from(self.limit / IMAGE_PAIR_BYTES).unwrap_or(usize::MAX);
        let more = self.pairs.len().max(4).min(most.saturating_sub(self.pairs.len()));
        let grown = more > 0 && self.pairs.try_reserve_exact(more).is_ok();
        if !grown {
            if self.before == 0 {
                self.pairs = Vec::new();
            }
            self.pairs.truncate(self.before);
        }
        grown
    }

    /// Returns the contacts in ascending order. `particles` is the scene's number of particles, for
    /// the error message. Fails with [`Refusal::Pairs`] if not all contacts were stored.
    pub fn end(mut self, particles: usize) -> Result<Vec<ImagePair>, Refusal> {
        if !self.is_complete() {
            return Err(Refusal::Pairs {
                found: self.found,
                particles: particles as u64,
                room: self.limit,
            });
        }
        self.pairs.sort_unstable();
        Ok(self.pairs)
    }
}
