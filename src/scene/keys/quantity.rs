//! What a number must be.

/// What a number must be, besides finite.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quantity {
    /// Completes "must be ...", with the unit.
    pub what: &'static str,
    /// The least that is accepted.
    pub least: Bound,
    /// The most that is accepted.
    pub most: Bound,
}

/// An end of a range.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Bound {
    /// Without end.
    None,
    /// The number itself is accepted.
    At(f64),
    /// The number itself is not accepted.
    Beyond(f64),
}

impl Quantity {
    /// Any finite number.
    pub const fn any(what: &'static str) -> Self {
        Self { what, least: Bound::None, most: Bound::None }
    }

    /// A number above zero.
    pub const fn positive(what: &'static str) -> Self {
        Self { what, least: Bound::Beyond(0.0), most: Bound::None }
    }

    /// A number of a range.
    pub const fn within(what: &'static str, least: Bound, most: Bound) -> Self {
        Self { what, least, most }
    }

    /// Whether a finite number is accepted.
    pub fn accepts(self, value: f64) -> bool {
        let above = match self.least {
            Bound::None => true,
            Bound::At(least) => value >= least,
            Bound::Beyond(least) => value > least,
        };
        let below = match self.most {
            Bound::None => true,
            Bound::At(most) => value <= most,
            Bound::Beyond(most) => value < most,
        };
        above && below
    }
}
