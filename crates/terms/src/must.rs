/// Returns `Err` with these words unless the condition holds, in a function whose error is a
/// `String`.
#[macro_export]
macro_rules! must {
    ($holds:expr, $($words:tt)*) => {
        if !$holds {
            return Err(format!($($words)*));
        }
    };
}
