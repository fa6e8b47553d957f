use anyhow::{Context, bail};

use super::{Particles, with_points};

impl Particles {
    pub fn ids_copied(&self) -> anyhow::Result<Option<Vec<i64>>> {
        let copied = |ids: &[i64]| {
            let mut copy = Vec::new();
            let room = copy.try_reserve_exact(ids.len());
            room.with_context(|| format!("no memory for {} ids", ids.len()))?;
            copy.extend_from_slice(ids);
            Ok(copy)
        };
        self.ids.as_deref().map(copied).transpose()
    }

    pub fn sort_by_id(&mut self) -> anyhow::Result<()> {
        let Some(ids) = &mut self.ids else { return Ok(()) };
        let n = ids.len();
        if !ids.windows(2).all(|two| two[0] < two[1]) {
            let mut order: Vec<u32> = Vec::new();
            let room = order.try_reserve_exact(n);
            room.with_context(|| format!("no memory for the order of {n} particles"))?;
            order.extend(0..n as u32);
            order.sort_unstable_by_key(|&k| ids[k as usize]);
            with_points!(&mut self.centres, points => ordered(points, &order)?);
            if let Some(radii) = &mut self.radii {
                ordered(radii, &order)?;
            }
            ordered(ids, &order)?;
        }
        if let Some(two) = ids.windows(2).find(|two| two[0] == two[1]) {
            bail!("the id {} stands twice; mend it, or leave the column out", two[0]);
        }
        Ok(())
    }
}

fn ordered<T: Copy>(values: &mut Vec<T>, order: &[u32]) -> anyhow::Result<()> {
    let mut sorted = Vec::new();
    let room = sorted.try_reserve_exact(order.len());
    room.with_context(|| format!("no memory for the order of {} particles", order.len()))?;
    sorted.extend(order.iter().map(|&k| values[k as usize]));
    *values = sorted;
    Ok(())
}
