/// Defines an enum whose values have names in records, tables and messages.
#[macro_export]
macro_rules! named {
    ($(#[$meta:meta])* pub enum $Name:ident {
        $($(#[$of:meta])* $Value:ident = $name:literal,)*
    }) => {
        $(#[$meta])*
        pub enum $Name {
            $($(#[$of])* $Value,)*
        }

        impl $Name {
            /// All values, in the order of their definition.
            pub const ALL: [$Name; [$($name),*].len()] = [$($Name::$Value),*];

            /// The name used in records, tables and messages.
            pub const fn name(self) -> &'static str {
                match self {
                    $($Name::$Value => $name,)*
                }
            }
        }
    };
}
