//! Options of the verbs that read particle files.

use std::path::Path;

use anyhow::ensure;
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};

use crate::cli::shared::scene::WithIds;
use contactbench_io as io;
use contactbench_io::{Boundaries, FileOption, FrameChoice, Given, Notice};
use contactbench_scenes::origin::Origin;
use contactbench_scenes::spec::{GENERATORS, Spec};
use contactbench_terms::nearest::{hint, nearest};

/// Options that add what a particle file leaves open, as listed in [`io::OPTIONS`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input {
    pub radius: Option<f64>,
    /// `None` if no frame was chosen.
    pub frame: Option<FrameChoice>,
    pub boundaries: Boundaries,
    options: io::Options,
}

/// Names of the options in [`Input`], for messages.
pub const OPTIONS: &str =
    "--radius, --dim, --frame, --columns, --format, --box, --periodic and --open";

fn argument(option: &'static FileOption) -> Arg {
    let FileOption { name, value, meaning, .. } = *option;
    let arg = Arg::new(name).long(name).help(meaning).help_heading("Particle file");
    if value.is_empty() {
        return arg.action(ArgAction::SetTrue);
    }
    let arg = arg.value_name(value).action(ArgAction::Set);
    match name {
        // Shells complete the names of formats.
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
    /// Returns the options for the readers; the default is the last frame.
    pub fn options(&self) -> io::Options {
        io::Options { frame: self.frame.unwrap_or(FrameChoice::Last), ..self.options }
    }

    /// Returns whether any option was given.
    pub fn is_said(&self) -> bool {
        *self != Input::default()
    }

    /// Returns the scene of a file, or of a generator such as `packed:dim=3,n=1000`, with a
    /// periodic box if it has one. A file has precedence.
    pub fn given(&self, text: &str) -> anyhow::Result<Given> {
        Ok(self.with_ids(text, false)?.0)
    }

    /// Like [`Input::given`], with the ids of the particles if wanted and present.
    pub fn with_ids(&self, text: &str, ids: bool) -> anyhow::Result<WithIds> {
        match self.origin(text)? {
            Origin::Made(spec) => {
                let given = spec.given()?;
                tell(text, &given.notices);
                Ok((given, None))
            }
            Origin::File(path, options) => {
                let (particles, _) = load(&path, self, io::Options { ids, ..*options })?;
                tell(text, &particles.notices);
                let ids = particles.ids_copied()?;
                Ok((particles.given(text, self.radius)?, ids))
            }
        }
    }

    /// Returns a generator with its parameters, or a file with the options to read it.
    pub fn origin(&self, text: &str) -> anyhow::Result<Origin> {
        let generated = text.split(':').next().is_some_and(is_generator);
        if generated && !io::exists(Path::new(text)) {
            ensure!(
                !self.is_said(),
                "{OPTIONS} are for files; for a generated scene, write parameters such as dim=3 \
                 into \
                 {text}"
            );
            return Ok(Origin::Made(Spec::parse(text)?));
        }
        let path = Path::new(text);
        if !io::exists(path) {
            let (name, rest) = text.split_once(':').unwrap_or((text, ""));
            let named = nearest(name, GENERATORS.iter().map(|generator| generator.name));
            let near = named.filter(|_| !text.contains(['.', '/']));
            let scene = rest.contains('=') && !text.contains(['/', '\\']);
            let colon = if rest.is_empty() { "" } else { ":" };
            let hint = near.map(|near| format!(" (did you mean {near}{colon}{rest}?)"));
            ensure!(
                !scene && hint.is_none(),
                "there is neither a file nor a scene '{text}'{}; see contactbench list scenes",
                hint.unwrap_or_default()
            );
        }
        Ok(Origin::File(path.to_owned(), Box::new(self.options())))
    }

    /// Prints which of several frames is read, unless one was chosen.
    pub fn tell_frame(&self, name: &str, frames: u64) {
        if frames > 1 && self.frame.is_none() {
            let last = frames - 1;
            say!("{name}: frame {last}, the last of 0 to {last}, is read (--frame)");
        }
    }
}

/// Reads the particles of one frame. Prints which one, unless a frame was chosen.
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

/// Passes the frames of a file to `body`, which reads them one by one.
pub fn frames<T>(
    path: &Path,
    options: io::Options,
    body: impl FnOnce(io::Frames<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    is_file(path)?;
    explained(path, io::frames(path, io::Options { frame: FrameChoice::All, ..options }, body))
}

/// Fails if the path is the name of a generated scene.
fn is_file(path: &Path) -> anyhow::Result<()> {
    let text = path.display().to_string();
    let scene = text.split(':').next().is_some_and(is_generator) && !io::exists(path);
    ensure!(
        !scene,
        "'{text}' is a scene, and this verb needs a file; write one first: contactbench scene \
         {text} -o scene.csv"
    );
    Ok(())
}

pub fn tell(name: &str, notices: &[Notice]) {
    for notice in notices {
        say!("{name}: {notice}");
    }
}

/// Notices about the frames of a file; each is printed once.
#[derive(Default)]
pub struct Told(Vec<Notice>);

impl Told {
    /// Prints notices unless they were printed before.
    pub fn tell(&mut self, name: &str, notices: &[Notice]) {
        for notice in notices {
            if !self.0.iter().any(|told| told.is_like(notice)) {
                tell(name, std::slice::from_ref(notice));
                self.0.push(notice.clone());
            }
        }
    }
}

/// Returns the name of the file, and its frame unless that is the first.
pub fn place(name: &str, about: &io::About) -> String {
    match about.frame {
        0 => name.to_string(),
        _ => format!("{name}: {}", about.which()),
    }
}

/// Adds the most similar name in the folder to the error of a missing file.
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
                let others = names.iter().map(String::as_str).filter(|other| *other != name);
                let near = hint(name, others);
                anyhow::anyhow!("{error:#}{near}")
            }
            _ => error,
        }
    })
}

fn is_generator(name: &str) -> bool {
    GENERATORS.iter().any(|generator| generator.name == name.trim())
}
