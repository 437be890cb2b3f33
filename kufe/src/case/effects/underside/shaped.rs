//! An underside with something added to its height.

use std::sync::Arc;

use kufe_mesh::Underside;

/// `height(x, y) + change(x, y, height)`.
pub(in crate::case::effects) struct Shaped<F> {
    /// The underside as it was.
    pub inner: Arc<dyn Underside>,
    /// The new height from place and old height [m].
    pub change: F,
    /// Which mirror symmetries survive.
    pub keeps: [bool; 2],
}

impl<F: Fn(f64, f64, f64) -> f64 + Send + Sync> Underside for Shaped<F> {
    fn height(&self, x: f64, y: f64) -> f64 {
        let height = self.inner.height(x, y);
        if height.is_finite() {
            (self.change)(x, y, height)
        } else {
            height
        }
    }

    fn extent(&self) -> [f64; 4] {
        self.inner.extent()
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        let inner = self.inner.mirror_symmetric();
        [inner[0] && self.keeps[0], inner[1] && self.keeps[1]]
    }
}
