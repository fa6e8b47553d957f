use crate::document::Block;
use crate::sections::{About, Section};
use contactbench_record::findings::trust::noise::{Noise, Twin};
use contactbench_terms::number::{percent, plural, with_interval};

pub fn section(about: &About<'_>) -> Option<Section> {
    Section::by_machine("Noise floor", about.cells, |cells| {
        let found = Noise::new(cells);
        let twins = found.twins.iter().map(sentence);
        let blocks = twins.chain([floor(&found)]).map(Block::paragraph).collect();
        (!found.twins.is_empty()).then_some(blocks)
    })
}

fn floor(found: &Noise) -> String {
    let mut words = format!(
        "The noise floor is a factor of {:.2}: nine in ten cells of twins differ by less. Smaller \
         differences between detectors are undecided.",
        found.floor
    );
    let sizes: Vec<String> =
        found.by_size().map(|(n, floor)| format!("{floor:.2} at N = {n}")).collect();
    if sizes.len() > 1 {
        words += &format!(
            " The floor depends on N (with fewer than five cells it is at least that of all): {}.",
            sizes.join(", ")
        );
    }
    words
}

fn sentence(twin: &Twin) -> String {
    let Twin { name, original, cells, outside, .. } = twin;
    let [overall, worst] = [&twin.overall, &twin.worst].map(with_interval);
    let [typical, by_chance] = [twin.typical, twin.by_chance].map(percent);
    let all = plural(*cells, "cell");
    format!(
        "{name} is the code of {original}, measured again as a second subject. Over {all} it takes \
         {overall} times as long. In a cell the two typically differ by {typical}, at worst by a \
         factor of {worst}. {outside} of {cells} intervals exclude 1; by chance {by_chance} of \
         them would."
    )
}
