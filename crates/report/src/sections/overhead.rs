//! What the harness adds to the times, in a sentence.

use super::{About, Section};
use crate::document::Block;
use contactbench_record::findings::overhead::{LEAST, Overhead};
use contactbench_terms::number::percent;

/// The section of a report, if the control that does nothing was timed: a sentence per machine.
pub fn section(about: &About<'_>) -> Option<Section> {
    Section::by_machine("What the harness adds", about.cells, |cells| {
        Overhead::new(cells).map(|found| vec![Block::paragraph(sentence(&found))])
    })
}

fn sentence(found: &Overhead) -> String {
    let Overhead { share, n, detector, scene, clear_from } = found;
    let at = format!(
        "{} of the time of the fastest detector at N = {n} ({detector}, {scene})",
        percent(*share)
    );
    let control = "the control that does nothing takes";
    let least = percent(LEAST);
    match clear_from {
        _ if *share < LEAST => {
            format!("The harness adds less than {least} to every time: {control} at most {at}.")
        }
        Some(n) => format!(
            "The harness adds up to {at}, and less than {least} from N = {n} on: that is what \
             the control that does nothing takes."
        ),
        None => format!("The harness adds MORE than {least} at every N: {control} up to {at}."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_said_or_that_it_is_too_large() {
        let said = |share, clear_from| {
            let (detector, scene) = ("nbs".into(), "packed, 2D".into());
            sentence(&Overhead { share, n: 10, detector, scene, clear_from })
        };
        let place = "of the time of the fastest detector at N = 10 (nbs, packed, 2D)";
        assert!(said(0.001, Some(10)).contains(&format!(
            "to every time: the control that does nothing takes at most 0.1% {place}"
        )));
        assert!(
            said(0.05, Some(1000))
                .contains(&format!("up to 5.0% {place}, and less than 1.0% from N = 1000 on"))
        );
        assert!(said(5.0, None).contains("adds MORE than 1.0% at every N"));
    }
}
