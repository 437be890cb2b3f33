//! The ice before it is loaded.

/// The height of the unloaded ice over the contact plane; the gap under a hull shrinks by it.
pub trait IceSurface: Send + Sync {
    /// Height [m] at (`x` [m], `y` [m]).
    fn height(&self, x: f64, y: f64) -> f64;

    /// Whether the height is even in x and even in y, to rounding.
    fn mirror_symmetric(&self) -> [bool; 2];

    /// Places (x, y) [m] where measured ice is above what is beside them, along x or across. None of ice that a formula says.
    fn highs(&self) -> &[[f64; 2]] {
        &[]
    }
}
