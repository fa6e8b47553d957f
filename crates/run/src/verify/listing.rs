//! Translates the entries of a list to contacts between particles of a scene.

use std::collections::{HashMap, HashSet};

use anyhow::{Context, bail};

use crate::verify::Job;
use contactbench_ground::periodic::{ContactList, ImagePair};
use contactbench_io as io;

/// Two particles by their numbers or ids in the list.
pub type NamedPair = [i64; 2];

#[derive(Clone, Copy, Debug)]
pub struct Listed<'a> {
    pub pairs: &'a [NamedPair],
    /// The image of the second particle of each pair, if the list has images.
    pub images: Option<&'a [[i32; 3]]>,
}

#[derive(Clone, Debug)]
pub enum Naming {
    /// Numbers are indices into the particle file, counted from this base.
    Base(i64),
    /// Numbers are ids of particles; the map leads to their indices.
    Ids(HashMap<i64, u32>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    Base(i64),
    Ids,
}

impl Naming {
    /// Returns a naming by ids. Fails if an id occurs twice.
    pub fn by_id(ids: &[i64]) -> anyhow::Result<Naming> {
        let mut places = HashMap::with_capacity(ids.len());
        for (k, &id) in ids.iter().enumerate() {
            if let Some(earlier) = places.insert(id, k as u32) {
                bail!(
                    "the id {id} stands twice in the file, at particles {earlier} and {k} (from \
                     0); fix it, or give --base"
                );
            }
        }
        Ok(Naming::Ids(places))
    }

    pub fn meaning(&self) -> Meaning {
        match self {
            Naming::Base(base) => Meaning::Base(*base),
            Naming::Ids(_) => Meaning::Ids,
        }
    }

    fn place(&self, name: i64, n: usize) -> Option<u32> {
        match self {
            Naming::Base(base) => name
                .checked_sub(*base)
                .and_then(|k| u32::try_from(k).ok())
                .filter(|&k| (k as usize) < n),
            Naming::Ids(ids) => ids.get(&name).copied(),
        }
    }

    fn names(&self, places: &[[u32; 2]]) -> Vec<NamedPair> {
        let ids: HashMap<u32, i64> = match self {
            Naming::Ids(ids) if !places.is_empty() => ids.iter().map(|(&id, &k)| (k, id)).collect(),
            _ => HashMap::new(),
        };
        let name = |k: u32| match self {
            Naming::Base(base) => i64::from(k) + base,
            Naming::Ids(_) => ids.get(&k).copied().unwrap_or(-1),
        };
        places.iter().map(|pair| pair.map(name)).collect()
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Listing {
    pub contacts: ContactList,
    pub has_images: bool,
    pub unknown: Vec<NamedPair>,
    /// Pairs listed in one direction only, although both are expected.
    pub one_sided: Vec<NamedPair>,
    pub left_out: u64,
    /// Number of pairs of a particle with itself, if the list has one for each particle. Codes that
    /// count a particle among its neighbours write such pairs; they are left out.
    pub selves: u64,
}

impl Listing {
    /// Translates the list of a job. With `both_sides`, each pair counts once that the list has in
    /// both directions. Fails if memory runs out.
    pub fn new(
        job: &Job<'_>,
        naming: &Naming,
        both_sides: bool,
        truth: &ContactList,
    ) -> anyhow::Result<Listing> {
        let (list, without, n) = (job.list, job.terms.without, job.space.scene().len());
        let has_images = list.images.is_some();
        let own = |k: usize| {
            let [i, j] = list.pairs[k];
            i == j && list.images.is_none_or(|images| images[k] == [0; 3])
        };
        // Without images, the pair may also be a contact of a particle with its own image.
        let may_touch = !has_images && truth.shifted.iter().any(|pair| pair.i == pair.j);
        let selves = if may_touch { 0 } else { selves(list.pairs, own, naming, n) };
        let mut listing = Listing { has_images, selves, ..Listing::default() };
        let mut sides = [ContactList::default(), ContactList::default()];
        if list.images.is_none() && !both_sides {
            let count = list.pairs.len();
            let room = sides[0].plain.try_reserve_exact(count);
            room.with_context(|| {
                format!("no memory for {count} pairs; compare a part of the scene")
            })?;
        }
        for (k, &[i, j]) in list.pairs.iter().enumerate() {
            if selves > 0 && own(k) {
                continue;
            }
            let (Some(a), Some(b)) = (naming.place(i, n), naming.place(j, n)) else {
                io::room(&mut listing.unknown)?;
                listing.unknown.push([i, j]);
                continue;
            };
            if without.is_some_and(|groups| groups.leave_out(a, b)) {
                listing.left_out += 1;
                continue;
            }
            let image = list.images.map_or([0; 3], |images| images[k]);
            let pair = ImagePair::new(a, b, image);
            let turned = both_sides && (pair.i, pair.j, pair.image) != (a, b, image);
            let side = &mut sides[usize::from(turned)];
            if image == [0; 3] {
                io::room(&mut side.plain)?;
                side.plain.push([pair.i, pair.j]);
            } else {
                io::room(&mut side.shifted)?;
                side.shifted.push(pair);
            }
        }
        sides.iter_mut().for_each(ContactList::sort);
        let [forward, backward] = sides;
        if !both_sides {
            return Ok(Listing { contacts: forward, ..listing });
        }
        listing.merge(&forward, &backward, naming)
    }

    /// Takes each pair once that stands in both directions.
    fn merge(
        self,
        forward: &ContactList,
        backward: &ContactList,
        naming: &Naming,
    ) -> anyhow::Result<Listing> {
        let mut single = Vec::new();
        let own = |pair: &[u32; 2]| pair[0] == pair[1];
        let turn = |pair: [u32; 2], forward| if forward { pair } else { [pair[1], pair[0]] };
        let plain = once([&forward.plain, &backward.plain], own, |pair, forward| {
            single.push(turn(pair, forward));
        });
        // Every contact here has an image. The reverse of a particle's contact with itself has
        // another image, so no contact is its own reverse.
        let shifted = once(
            [&forward.shifted, &backward.shifted],
            |_| false,
            |pair, forward| {
                single.push(turn([pair.i, pair.j], forward));
            },
        );
        let contacts = ContactList { plain: plain?, shifted: shifted? };
        Ok(Listing { contacts, one_sided: naming.names(&single), ..self })
    }
}

/// Returns the number of pairs of a particle with itself, if each particle has exactly one;
/// otherwise 0.
fn selves(pairs: &[NamedPair], own: impl Fn(usize) -> bool, naming: &Naming, n: usize) -> u64 {
    let all = || (0..pairs.len()).filter(|&k| own(k)).map(|k| pairs[k][0]);
    let distinct = || all().filter_map(|name| naming.place(name, n)).collect::<HashSet<u32>>();
    if n > 1 && all().count() == n && distinct().len() == n { n as u64 } else { 0 }
}

/// Merges pairs listed in both directions. Passes to `single` each pair listed more often in one
/// direction, and whether that is the first. A pair that is its `own` reverse counts half.
fn once<C: Copy + Ord>(
    [forward, backward]: [&[C]; 2],
    own: impl Fn(&C) -> bool,
    mut single: impl FnMut(C, bool),
) -> anyhow::Result<Vec<C>> {
    let mut taken = Vec::new();
    let mut sides = [forward, backward].map(|side| side.chunk_by(|a, b| a == b).peekable());
    loop {
        let first = sides.iter_mut().filter_map(|side| side.peek().map(|same| same[0])).min();
        let Some(pair) = first else { return Ok(taken) };
        let [forward, backward] =
            sides.each_mut().map(|side| side.next_if(|same| same[0] == pair).map_or(0, <[C]>::len));
        let count = match own(&pair) {
            true => (forward + backward).div_ceil(2),
            false => forward.max(backward),
        };
        for _ in 0..count {
            io::room(&mut taken)?;
            taken.push(pair);
        }
        if !own(&pair) && forward != backward {
            single(pair, forward > backward);
        }
    }
}
