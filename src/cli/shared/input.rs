//! What the verbs that read files ask about them.

use std::path::Path;

use anyhow::{bail, ensure};
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};

use crate::cli::shared::scene::WithIds;
use contactbench_core::contact::Arithmetic;
use contactbench_core::scene::AnyScene;
use contactbench_io as io;
use contactbench_io::Given;
use contactbench_io::{Boundaries, FileOption, Frame, Notice, Place, RadiusSource};
use contactbench_scenes::doubts::{Touching, doubts};
use contactbench_scenes::origin::Origin;
use contactbench_scenes::spec::{GENERATORS, Spec};
use contactbench_terms::nearest::{hint, nearest};

/// What a file does not say: the options of [`io::OPTIONS`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input {
    /// The radius of all particles.
    pub radius: Option<f64>,
    /// The frame; none if no frame was chosen.
    pub frame: Option<Frame>,
    /// The box.
    pub boundaries: Boundaries,
    options: io::Options,
}

/// The options of [`Input`], for messages.
pub const OPTIONS: &str =
    "--radius, --dim, --frame, --columns, --format, --box, --periodic and --open";

fn argument(option: &'static FileOption) -> Arg {
    let FileOption { name, value, meaning, .. } = *option;
    let arg = Arg::new(name).long(name).help(meaning);
    if value.is_empty() {
        return arg.action(ArgAction::SetTrue);
    }
    let arg = arg.value_name(value).action(ArgAction::Set);
    match name {
        // Completions offer its values.
        "format" => {
            let all = io::FORMATS.iter();
            let all = all.map(|format| PossibleValue::new(format.key).help(format.help));
            arg.value_parser(PossibleValuesParser::new(all)).hide_possible_values(true)
        }
        _ => arg
            .allow_negative_numbers(true)
            .allow_hyphen_values(name == "box")
            .value_parser(|text: &str| option.check(text)),
    }
}

impl Args for Input {
    fn augment_args(command: Command) -> Command {
        command.args(io::OPTIONS.iter().map(argument))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Input::augment_args(command)
    }
}

impl FromArgMatches for Input {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Input, clap::Error> {
        let mut input = Input::default();
        for option in &io::OPTIONS {
            let name = option.name;
            let mut given = matches.get_raw(name).into_iter().flatten();
            let text = given.next().map(|text| text.to_string_lossy().into_owned());
            let is_said = matches.value_source(name) == Some(ValueSource::CommandLine);
            let Some(text) = text.filter(|_| is_said) else { continue };
            let set = option.set(&mut input.options, &text);
            set.map_err(|why| clap::Error::raw(ErrorKind::ValueValidation, why))?;
            input.frame = (name == "frame").then_some(input.options.frame).or(input.frame);
        }
        (input.radius, input.boundaries) = (input.options.radius, input.options.boundaries);
        Ok(input)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Input::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Input {
    /// The same for the readers: without a choice the last frame.
    pub fn options(&self) -> io::Options {
        io::Options { frame: self.frame.unwrap_or(Frame::Last), ..self.options }
    }

    /// Was anything said?
    pub fn is_said(&self) -> bool {
        *self != Input::default()
    }

    /// The scene of a file, or of a generator such as `packed:dim=3,n=1000`. What is there as a
    /// file is a file. One with a box that repeats is refused.
    pub fn scene(&self, text: &str) -> anyhow::Result<AnyScene<'static>> {
        let given = self.make(text, false, |particles| {
            let source = particles.source.clone();
            Ok(Given { source, ..particles.scene(text, self.radius)?.into() })
        })?;
        doubt_given(text, &given, Arithmetic::Exact);
        given.open(text)
    }

    /// The same with the box in which it repeats, for those who know what to do with one.
    pub fn given(&self, text: &str) -> anyhow::Result<Given> {
        self.make(text, false, |particles| particles.given(text, self.radius))
    }

    /// The same with the ids of the particles, if they are wanted and there.
    pub fn with_ids(&self, text: &str, wanted: bool) -> anyhow::Result<WithIds> {
        let mut ids = None;
        let given = self.make(text, wanted, |particles| {
            ids = particles.ids_copied()?;
            particles.given(text, self.radius)
        })?;
        Ok((given, ids))
    }

    fn make(
        &self,
        text: &str,
        ids: bool,
        of: impl FnOnce(io::Particles) -> anyhow::Result<Given>,
    ) -> anyhow::Result<Given> {
        match self.origin(text)? {
            Origin::Made(spec) => {
                let given = spec.given()?;
                tell(text, &given.notices, Place::Spec);
                Ok(given)
            }
            Origin::File(path, options) => {
                let (particles, _) = load(&path, self, io::Options { ids, ..*options })?;
                tell(text, &particles.notices, Place::Argument);
                of(particles)
            }
        }
    }

    /// A generator with its parameters, or a file and how to read it. What is there as a file is a
    /// file.
    pub fn origin(&self, text: &str) -> anyhow::Result<Origin> {
        let generated =
            text.split_once(':').is_some_and(|(name, _)| is_generator(name)) || is_generator(text);
        if generated && !io::exists(Path::new(text)) {
            ensure!(
                !self.is_said(),
                "{OPTIONS} belong to files; write dim=3 and the like into the scene: {text}"
            );
            return Ok(Origin::Made(Spec::parse(text)?));
        }
        let path = Path::new(text);
        if !io::exists(path) {
            let (name, rest) = text.split_once(':').unwrap_or((text, ""));
            let named = nearest(name, GENERATORS.iter().map(|generator| generator.name));
            if let Some(near) = named.filter(|_| !text.contains(['.', '/'])) {
                let colon = if rest.is_empty() { "" } else { ":" };
                bail!(
                    "there is neither a file nor a scene '{text}'; did you mean \
                     {near}{colon}{rest}? (contactbench list scenes)"
                );
            }
        }
        Ok(Origin::File(path.to_owned(), Box::new(self.options())))
    }

    /// Says which of several frames is read where nobody chose one.
    pub fn tell_frame(&self, name: &str, frames: u64) {
        if frames > 1 && self.frame.is_none() {
            let last = frames - 1;
            say!("{name}: frame {last}, the last of 0 to {last}, is read (--frame)");
        }
    }
}

/// Particles and what is known of them. Which of several frames was taken is said where nobody
/// chose one.
pub fn load(
    path: &Path,
    input: &Input,
    options: io::Options,
) -> anyhow::Result<(io::Particles, io::About)> {
    is_file(path)?;
    let (particles, about) = explained(path, io::load(path, options))?;
    input.tell_frame(&path.display().to_string(), about.frames);
    Ok((particles, about))
}

/// Hands all frames of a file to `body`, which takes them one by one.
pub fn frames<T>(
    path: &Path,
    options: io::Options,
    body: impl FnOnce(io::Frames<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    is_file(path)?;
    explained(path, io::frames(path, io::Options { frame: Frame::All, ..options }, body))
}

/// Refuses the name of a scene.
fn is_file(path: &Path) -> anyhow::Result<()> {
    let text = path.display().to_string();
    let scene = text.split(':').next().is_some_and(is_generator) && !io::exists(path);
    ensure!(
        !scene,
        "'{text}' is a scene, and a file is wanted here; write it to one first: contactbench \
         scene {text} -o scene.csv"
    );
    Ok(())
}

/// Says what a file leaves open about its box.
pub fn tell(name: &str, notices: &[Notice], place: Place) {
    for notice in notices {
        say!("{name}: {}", notice.words(place));
    }
}

/// Prints what is doubtful about the particles of a file and these contacts; nothing of a scene
/// that is made.
pub fn doubt(
    name: &str,
    scene: &AnyScene<'_>,
    source: Option<&RadiusSource>,
    arithmetic: Arithmetic,
    touching: Option<&Touching>,
) {
    if let Some(source) = source {
        tell(name, &doubts(scene, source, arithmetic, touching), Place::Argument);
    }
}

/// The same for verbs that do not list contacts themselves.
pub fn doubt_given(name: &str, given: &Given, arithmetic: Arithmetic) {
    if given.source.is_some() {
        let touching = Touching::search(given);
        doubt(name, &given.scene, given.source.as_ref(), arithmetic, touching.as_ref());
    }
}

/// What has been said of the frames of a file: each notice once, and that nothing touches only if
/// nothing does in any.
#[derive(Default)]
pub struct Told {
    notices: Vec<Notice>,
    /// That nothing touches in the last frame, and what follows from it.
    waiting: Vec<Notice>,
    touched: bool,
}

impl Told {
    /// Prints what the reader assumed of a frame.
    pub fn of_reader(&mut self, name: &str, particles: &io::Particles, about: &io::About) {
        self.tell(&place(name, about), &particles.notices);
    }

    /// Prints what is doubtful about a frame.
    pub fn of_contacts(
        &mut self,
        place: &str,
        scene: &AnyScene<'_>,
        source: Option<&RadiusSource>,
        arithmetic: Arithmetic,
        touching: Option<&Touching>,
    ) {
        let Some(source) = source else { return };
        let found = doubts(scene, source, arithmetic, touching);
        let apart = found.contains(&Notice::Apart);
        let waits = |notice: &Notice| apart && matches!(notice, Notice::Apart | Notice::Scaled);
        let (waiting, now): (Vec<_>, Vec<_>) = found.into_iter().partition(waits);
        self.touched |= !apart;
        self.waiting = waiting;
        self.tell(place, &now);
    }

    /// The same, where the verb does not list the contacts. Once something touches, later frames
    /// are not searched.
    pub fn of_given(&mut self, place: &str, given: &Given, arithmetic: Arithmetic) {
        if !self.touched && given.source.is_some() {
            let touching = Touching::search(given);
            let source = given.source.as_ref();
            self.of_contacts(place, &given.scene, source, arithmetic, touching.as_ref());
        }
    }

    /// After the last frame.
    pub fn end(self, name: &str) {
        if !self.touched {
            tell(name, &self.waiting, Place::Argument);
        }
    }

    fn tell(&mut self, name: &str, notices: &[Notice]) {
        for notice in notices {
            if !self.notices.iter().any(|told| told.is_like(notice)) {
                tell(name, std::slice::from_ref(notice), Place::Argument);
                self.notices.push(notice.clone());
            }
        }
    }
}

/// The file, and its frame, where that is not the first.
pub fn place(name: &str, about: &io::About) -> String {
    match about.frame {
        0 => name.to_string(),
        _ => format!("{name}: {}", about.which()),
    }
}

/// With the file beside it that may be meant, where there is none of that name.
fn explained<T>(path: &Path, result: anyhow::Result<T>) -> anyhow::Result<T> {
    result.map_err(|error| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let entries = std::fs::read_dir(folder.unwrap_or(Path::new(".")));
        let names: Vec<String> = entries
            .into_iter()
            .flatten()
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .collect();
        match path.file_name().and_then(|name| name.to_str()) {
            Some(name) if !io::exists(path) => {
                let near = hint(name, names.iter().map(String::as_str));
                anyhow::anyhow!("{error:#}{near}")
            }
            _ => error,
        }
    })
}

fn is_generator(name: &str) -> bool {
    GENERATORS.iter().any(|generator| generator.name == name.trim())
}
