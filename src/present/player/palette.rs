//! The colours of pages that step, and of pictures of their steps.

/// Colours.
pub struct Palette {
    /// The ground.
    pub ground: &'static str,
    /// Text.
    pub ink: &'static str,
    /// Text that matters less.
    pub faint: &'static str,
    /// Thin lines.
    pub line: &'static str,
    /// Cells without particles.
    pub border: &'static str,
    /// A disc and its rim.
    pub disc: [&'static str; 2],
    /// A row that is looked at, and the one below.
    pub row: [&'static str; 2],
    /// The cell whose particles are tested.
    pub central: &'static str,
    /// What is looked at.
    pub look: &'static str,
    /// What the step is about.
    pub accent: &'static str,
    /// Pairs that touch.
    pub contact: &'static str,
}

/// On paper, and in bright rooms.
pub const LIGHT: Palette = Palette {
    ground: "#ffffff",
    ink: "#1b1f26",
    faint: "#6b7480",
    line: "#c3cad2",
    border: "#f0f1f3",
    disc: ["#c9dcf0", "#46688c"],
    row: ["#fff2c9", "#fbf7ea"],
    central: "#ffd152",
    look: "#d8c9f2",
    accent: "#d05a00",
    contact: "#0b4f9e",
};

/// On dark screens.
pub const DARK: Palette = Palette {
    ground: "#12151a",
    ink: "#eef1f5",
    faint: "#98a2af",
    line: "#434c58",
    border: "#1c2128",
    disc: ["#2f4a69", "#9cc2ea"],
    row: ["#3d350f", "#262313"],
    central: "#8a6a00",
    look: "#513f80",
    accent: "#ff9a3d",
    contact: "#7fbcff",
};
