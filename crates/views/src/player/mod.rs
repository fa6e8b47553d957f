//! Common parts of pages with steps: buttons, keys, swipes, the address, light and dark mode.

pub const STYLE: &str = include_str!("player.css");
pub const SCRIPT: &str = include_str!("player.js");

/// Colours of pages with steps and of their pictures, for light and dark screens.
const COLOURS: [(&str, [&str; 2]); 14] = [
    ("@ground", ["#ffffff", "#12151a"]),
    // Text, then less important text.
    ("@ink", ["#1b1f26", "#eef1f5"]),
    ("@faint", ["#6b7480", "#98a2af"]),
    ("@line", ["#c3cad2", "#434c58"]),
    // Cells without particles.
    ("@border", ["#f0f1f3", "#1c2128"]),
    ("@disc", ["#c9dcf0", "#2f4a69"]),
    ("@rim", ["#46688c", "#9cc2ea"]),
    // The central row, the row below it, and the cell whose particles are tested.
    ("@row", ["#fff2c9", "#3d350f"]),
    ("@below", ["#fbf7ea", "#262313"]),
    ("@central", ["#ffd152", "#8a6a00"]),
    // Values read in this step, then what the step is about.
    ("@look", ["#d8c9f2", "#513f80"]),
    ("@accent", ["#d05a00", "#ff9a3d"]),
    ("@contact", ["#0b4f9e", "#7fbcff"]),
    // Contacts that a tracker missed.
    ("@missed", ["#d11507", "#ff6b5e"]),
];

/// Escapes data for a script element, so that the data cannot end the element.
pub fn data(value: &serde_json::Value) -> String {
    value.to_string().replace("</", "<\\/")
}

/// Replaces names of colours in CSS, such as `@ink`, by their values.
pub fn painted(rules: &str, dark: bool) -> String {
    COLOURS.iter().fold(rules.to_string(), |rules, (name, colours)| {
        rules.replace(name, colours[usize::from(dark)])
    })
}
