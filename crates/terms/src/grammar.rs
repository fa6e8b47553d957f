//! The grammar of names with parameters. Scenes, motions and detectors are written
//! `name:key=value,key=value`; trackers are written `name(over,key=value)`.

use crate::nearest::hint;

/// Parameters that belong to a tracker; all others in its text belong to its detector.
pub const TRACKER: [&str; 2] = ["rule", "skin"];

/// A name with parameters, as written. Blanks around names, keys and values are removed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spec<'a> {
    /// The text as a whole, for messages.
    pub text: &'a str,
    /// The text before the colon or the parenthesis.
    pub name: &'a str,
    /// The detector of a tracker, with the detector's parameters.
    pub over: Option<String>,
    /// Keys and values, in the given order.
    pub params: Vec<(&'a str, String)>,
    /// The first piece of the text that does not fit the grammar.
    pub stray: Option<&'a str>,
}

/// An error in a text: the text, the wrong piece of it, and what is allowed there.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{text}': {what}")]
pub struct Error {
    text: String,
    what: String,
}

impl<'a> Spec<'a> {
    /// Splits `name:key=value,key=value`. A piece without `=` belongs to the value before it,
    /// because a path may contain commas.
    pub fn parse(text: &'a str) -> Spec<'a> {
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let mut spec = Spec { text, name: name.trim(), over: None, params: vec![], stray: None };
        for piece in rest.split(',') {
            match (piece.split_once('='), spec.params.last_mut()) {
                (Some((key, value)), _) => spec.params.push((key.trim(), value.trim().into())),
                (None, Some((_, value))) => *value = format!("{value},{piece}"),
                (None, None) if piece.trim().is_empty() => {}
                (None, None) => spec.stray = spec.stray.or(Some(piece.trim())),
            }
        }
        spec
    }

    /// Splits `name(over,key=value)`. The keys in [`TRACKER`] belong to `name`, all other pieces to
    /// `over`. A text without a parenthesis is split by [`Spec::parse`].
    pub fn parse_tracker(text: &'a str) -> Spec<'a> {
        let Some((name, rest)) = text.trim().split_once('(') else { return Spec::parse(text) };
        let stray = (!rest.ends_with(')')).then_some(text);
        let (mut params, mut over) = (Vec::new(), Vec::new());
        for piece in rest.strip_suffix(')').unwrap_or(rest).split(',') {
            match piece.split_once('=').map(|(key, value)| (key.trim(), value.trim())) {
                Some((key, value)) if TRACKER.contains(&key) => params.push((key, value.into())),
                _ => over.push(piece),
            }
        }
        let over = Some(over.join(",").trim().to_string());
        Spec { text, name: name.trim(), over, params, stray }
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&str> {
        self.params.iter().find(|(known, _)| *known == key).map(|(_, value)| value.as_str())
    }

    /// Checks that every piece fits the grammar and no key occurs twice. `takes` describes the
    /// allowed parameters, for the message.
    ///
    /// # Errors
    /// Names the first piece that does not fit, or the first key that occurs twice.
    pub fn form(&self, takes: &str) -> Result<(), Error> {
        if let Some(piece) = self.stray {
            return Err(self.error(format!("'{piece}' is not of the form key=value; {takes}")));
        }
        let mut keys = self.params.iter().map(|(key, _)| *key).enumerate();
        match keys.find(|(k, key)| self.params[..*k].iter().any(|(other, _)| other == key)) {
            Some((_, key)) => Err(self.error(format!("{key} is given twice; leave one out"))),
            None => Ok(()),
        }
    }

    fn error(&self, what: String) -> Error {
        Error { text: self.text.into(), what }
    }

    /// Checks the same as [`Spec::form`], and that all keys are among `known`.
    ///
    /// # Errors
    /// Fails as [`Spec::form`] does, and for the first unknown key.
    pub fn keys(&self, known: &[&str], takes: &str) -> Result<(), Error> {
        self.form(takes)?;
        match self.params.iter().find(|(key, _)| !known.contains(key)) {
            Some((key, _)) => {
                let hint = hint(key, known.iter().copied());
                Err(self.error(format!("there is no parameter '{key}'{hint}; {takes}")))
            }
            None => Ok(()),
        }
    }

    /// Builds the error for a value that is not allowed for `key`. `allowed` describes the allowed
    /// values; `words` lists those that are names, for a suggestion.
    pub fn wrong(&self, key: &str, value: &str, words: &[&str], allowed: &str) -> Error {
        let hint = hint(value, words.iter().copied());
        self.error(format!("{key} cannot be '{value}'{hint}; it is {allowed}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(spec: &Spec<'_>) -> String {
        let params = spec.params.iter().map(|(key, value)| format!("{key}={value}"));
        format!("{} {:?} {}", spec.name, spec.over, params.collect::<Vec<_>>().join(" "))
    }

    #[test]
    fn texts_are_split_at_their_commas() {
        for (text, parts) in [
            ("nbs", "nbs None "),
            (" packed : n = 3 ,seed=2", "packed None n=3 seed=2"),
            ("file:path=a,b,dim=3", "file None path=a,b dim=3"),
            ("nbs:", "nbs None "),
        ] {
            let spec = Spec::parse(text);
            assert_eq!((shown(&spec), spec.form("")), (parts.into(), Ok(())), "{text}");
        }
        let text = " verlet( rule = every-5 , nbs:form=a, level=b,skin =1e-3)";
        let spec = Spec::parse_tracker(text);
        let parts = "verlet Some(\"nbs:form=a, level=b\") rule=every-5 skin=1e-3";
        assert_eq!((shown(&spec), spec.get("skin")), (parts.into(), Some("1e-3")));
    }

    #[test]
    fn what_is_wrong_is_named_with_what_is_allowed() {
        let keys = |text| Spec::parse(text).keys(&["speed", "seed"], "drift takes speed and seed");
        for (text, words) in [
            ("drift:3", "'drift:3': '3' is not of the form key=value; drift takes speed and seed"),
            ("drift:seed=1,seed=2", "'drift:seed=1,seed=2': seed is given twice; leave one out"),
            (
                "drift:sped=1",
                "'drift:sped=1': there is no parameter 'sped' (did you mean speed?); drift takes \
                 speed and seed",
            ),
        ] {
            assert_eq!(keys(text).unwrap_err().to_string(), words);
        }
        assert!(Spec::parse_tracker("verlet(nbs").form("").is_err());
        assert_eq!(
            Spec::parse("a:b=dens").wrong("b", "dens", &["dense"], "auto or dense").to_string(),
            "'a:b=dens': b cannot be 'dens' (did you mean dense?); it is auto or dense"
        );
    }
}
