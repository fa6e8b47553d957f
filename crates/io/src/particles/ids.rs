use anyhow::{Context, bail};

use super::{Particles, with_points};

impl Particles {
    pub fn ids_copied(&self) -> anyhow::Result<Option<Vec<i64>>> {
        let copied = |ids: &[i64]| collected(ids.len(), ids.iter().copied());
        self.ids.as_deref().map(copied).transpose()
    }

    pub fn sort_by_id(&mut self) -> anyhow::Result<()> {
        let Some(ids) = &mut self.ids else { return Ok(()) };
        if !ids.windows(2).all(|two| two[0] < two[1]) {
            let mut order = collected(ids.len(), 0..ids.len() as u32)?;
            order.sort_unstable_by_key(|&k| ids[k as usize]);
            with_points!(&mut self.centres, points => ordered(points, &order)?);
            if let Some(radii) = &mut self.radii {
                ordered(radii, &order)?;
            }
            ordered(ids, &order)?;
        }
        if let Some(two) = ids.windows(2).find(|two| two[0] == two[1]) {
            bail!("the id {} stands twice; fix it, or leave the column out", two[0]);
        }
        Ok(())
    }
}

fn collected<T>(n: usize, values: impl Iterator<Item = T>) -> anyhow::Result<Vec<T>> {
    let mut list = Vec::new();
    let room = list.try_reserve_exact(n);
    room.with_context(|| format!("no memory for the ids of {n} particles"))?;
    list.extend(values);
    Ok(list)
}

fn ordered<T: Copy>(values: &mut Vec<T>, order: &[u32]) -> anyhow::Result<()> {
    *values = collected(order.len(), order.iter().map(|&k| values[k as usize]))?;
    Ok(())
}
