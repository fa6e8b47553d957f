use super::{About, Section};
use crate::document::Block;
use contactbench_record::findings::overhead::{LEAST, Overhead};
use contactbench_terms::number::percent;

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
            "The harness adds up to {at}, and less than {least} from N = {n} on. This is the time \
             of the control that does nothing."
        ),
        None => format!("The harness adds MORE than {least} at every N: {control} up to {at}."),
    }
}
