//! Enumerations whose values have names: the words that users write and read.

/// An enumeration whose values are told apart by their names, in the order in which users see them.
macro_rules! named {
    ($(#[$doc:meta])* $kind:ident, $what:literal { $($(#[$line:meta])* $value:ident => $text:literal,)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $kind {
            $($(#[$line])* $value,)*
        }

        impl $kind {
            /// All values, in the order in which users see them.
            pub const ALL: &'static [Self] = &[$(Self::$value,)*];

            /// The word that users write and read.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$value => $text,)* }
            }

            /// The value of that name.
            #[must_use]
            pub fn from_name(name: &str) -> Option<Self> {
                match name { $($text => Some(Self::$value),)* _ => None }
            }

            /// The position in [`ALL`](Self::ALL).
            #[must_use]
            pub const fn code(self) -> u8 {
                self as u8
            }
        }

        #[cfg(feature = "alloc")]
        impl core::str::FromStr for $kind {
            type Err = $crate::error::Error;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                Self::from_name(name).ok_or_else(|| $crate::error::Error::Name {
                    what: $what,
                    given: name.into(),
                    known: [$($text,)*].join(", "),
                })
            }
        }

        impl core::fmt::Display for $kind {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.pad(self.name())
            }
        }
    };
}

pub(crate) use named;
