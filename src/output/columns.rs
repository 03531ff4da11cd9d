//! The one place that names what is recorded: history columns, interface fields, bulk fields. A new column is one line.

use crate::energy::{Energy, HeatEnergy};

/// One row of `/history`: the state at the end of an accepted step (row 0: the unloaded state). Forces are per unit
/// thickness (N/m), in space N. The default is the unloaded state at t = 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HistoryRow {
    /// Time, s.
    pub time: f64,
    /// Index of the phase that the step belongs to; row 0 belongs to phase 0.
    pub phase: usize,
    /// Imposed normal approach of the indenter, m.
    pub approach: f64,
    /// Imposed tangential displacement of the indenter, m.
    pub sliding: f64,
    /// N_z = ∫ p dx, N/m, compression positive.
    pub normal_force: f64,
    /// Q_x = ∫ q dx, N/m, traction on the layer, positive along +x.
    pub tangential_force: f64,
    /// ∫ p ∂h/∂x dx, N/m, with h at its present position.
    pub hysteretic_force: f64,
    /// Share of the contact face that is in contact.
    pub contact_fraction: f64,
    /// Share of the contact that sticks.
    pub stick_fraction: f64,
    /// Largest penetration, m, positive.
    pub max_penetration: f64,
    /// Largest slip of a sticking point while it was to stick, m.
    pub stuck_slip: f64,
    /// How much the tractions oscillate from node to node; 1 = nothing but a checkerboard.
    pub traction_oscillation: f64,
    /// Newton iterations that the step took.
    pub newton_iterations: usize,
    /// What vectors have along y.
    pub across: Across,
    /// Where the far end of the normal mount is, m; recorded where there is one.
    pub mount_normal: f64,
    /// That of the tangential one.
    pub mount_tangential: f64,
    /// What has worn off, m^2 (m^3 in space); recorded where something wears.
    pub worn_volume: f64,
    /// The energy balance; recorded where it is asked for.
    pub energy: Energy,
    /// The temperature of the body; recorded where it is modelled.
    pub heat: HeatRow,
}

/// What a [`HistoryRow`] says of the temperature.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HeatRow {
    /// The highest of the body, K.
    pub highest: f64,
    /// Its mean, by heat capacity, K.
    pub mean: f64,
    /// The balance of heat; recorded where the energy balance is.
    pub energy: HeatEnergy,
}

/// The components along y of the vectors of a [`HistoryRow`]; none in the plane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Across {
    /// m
    pub sliding: f64,
    /// N
    pub tangential_force: f64,
    /// N
    pub hysteretic_force: f64,
    /// m
    pub mount_tangential: f64,
}

/// One row of the fields under `/interface`; every field has one value, or the components of one vector, for each node of the
/// contact face, in the order of [`Plan::face`](super::Plan::face).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InterfaceFrame {
    /// Time, s.
    pub time: f64,
    /// Contact pressure, Pa, positive in compression.
    pub pressure: Vec<f64>,
    /// Tangential traction on the layer, Pa, positive along +x; in space x and y of it.
    pub shear: Vec<f64>,
    /// Normal gap, m, negative where the indenter penetrates.
    pub gap: Vec<f64>,
    /// Slip rate, m/s; in space x and y of it.
    pub slip_rate: Vec<f64>,
    /// In the plane: displacement of the face along x, m.
    pub displacement_x: Vec<f64>,
    /// In the plane: displacement of the face along z, m.
    pub displacement_z: Vec<f64>,
    /// In space: x, y and z of the displacement of the face, m.
    pub displacement: Vec<f64>,
    /// Where something wears: the depth that has worn off, m; of an indenter at the same x in its own frame.
    pub worn_depth: Vec<f64>,
    /// Where the indenter wears: its profile, m, at x in its own frame.
    pub worn_profile: Vec<f64>,
    /// With heat: temperature, K.
    pub temperature: Vec<f64>,
    /// With heat: what enters the body, less what the air takes, W/m^2.
    pub heat_flux: Vec<f64>,
}

/// Where a history column has its number in a row; also the type it has in the file (float64 or int64).
pub(super) enum Value {
    Real(Place),
    Count(fn(&mut HistoryRow) -> &mut usize),
    /// Along x, and in space along y.
    Along([Place; 2]),
}

/// Where a number is in a row.
type Place = fn(&mut HistoryRow) -> &mut f64;

/// A column of the history.
pub(super) struct Column {
    pub name: &'static str,
    pub units: &'static str,
    pub long_name: &'static str,
    pub value: Value,
}

const fn real(
    name: &'static str,
    units: &'static str,
    long_name: &'static str,
    value: fn(&mut HistoryRow) -> &mut f64,
) -> Column {
    Column { name, units, long_name, value: Value::Real(value) }
}

const fn along(name: &'static str, units: &'static str, long_name: &'static str, value: [Place; 2]) -> Column {
    Column { name, units, long_name, value: Value::Along(value) }
}

const fn count(name: &'static str, long_name: &'static str, value: fn(&mut HistoryRow) -> &mut usize) -> Column {
    Column { name, units: "1", long_name, value: Value::Count(value) }
}

/// Which columns a history has besides those that all have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Extra {
    /// The energy balance.
    pub energy: bool,
    /// The far ends of the mounts, normal and tangential, and what they add to the balance.
    pub mounts: [bool; 2],
    /// The worn volume and depth, and what wear takes of the balance.
    pub wear: bool,
    /// The profile of an indenter that wears.
    pub worn_profile: bool,
    /// The temperature of the body; also of its fields.
    pub heat: bool,
    /// What adhesion takes of the balance.
    pub adhesion: bool,
}

impl Extra {
    /// What all rows can have.
    pub const ALL: Self =
        Self { energy: true, mounts: [true; 2], wear: true, worn_profile: true, heat: true, adhesion: true };
}

/// The columns of `/history`. `time` is the last: the lengths reach the file in this order (see [`super`]).
#[rustfmt::skip]
pub(super) const HISTORY: &[Column] = &[
    count("phase", "index of the phase, see the attribute names", |r| &mut r.phase),
    real("approach", "m", "imposed normal approach of the indenter", |r| &mut r.approach),
    along("sliding", "m", "imposed tangential displacement of the indenter", [|r| &mut r.sliding, |r| &mut r.across.sliding]),
    real("normal_force", "N/m", "normal force per unit thickness, compression positive", |r| &mut r.normal_force),
    along("tangential_force", "N/m", "tangential force on the layer per unit thickness, positive along +x", [|r| &mut r.tangential_force, |r| &mut r.across.tangential_force]),
    along("hysteretic_force", "N/m", "integral of pressure times slope of the profile, per unit thickness", [|r| &mut r.hysteretic_force, |r| &mut r.across.hysteretic_force]),
    real("contact_fraction", "1", "share of the contact face in contact", |r| &mut r.contact_fraction),
    real("stick_fraction", "1", "share of the contact that sticks", |r| &mut r.stick_fraction),
    real("max_penetration", "m", "largest penetration", |r| &mut r.max_penetration),
    real("stuck_slip", "m", "largest slip of a point since it began to stick, which the regularisation lets it do", |r| &mut r.stuck_slip),
    real("traction_oscillation", "1", "node-to-node oscillation of the tractions over their rms, 1 = a checkerboard", |r| &mut r.traction_oscillation),
    count("newton_iterations", "Newton iterations of the step", |r| &mut r.newton_iterations),
    real("time", "s", "time", |r| &mut r.time),
];

/// The columns of `/history/energy`, present when the energy balance is recorded.
#[rustfmt::skip]
pub(super) const ENERGY: &[Column] = &[
    real("energy/external_work", "J/m", "work of the indenter since t = 0", |r| &mut r.energy.external_work),
    real("energy/stored", "J/m", "energy stored in the springs of the layer", |r| &mut r.energy.stored),
    real("energy/viscoelastic_dissipation", "J/m", "energy dissipated in the Prony arms since t = 0", |r| &mut r.energy.viscoelastic_dissipation),
    real("energy/friction_dissipation", "J/m", "energy dissipated by friction since t = 0", |r| &mut r.energy.friction_dissipation),
    real("energy/penalty", "J/m", "energy stored in the penalty", |r| &mut r.energy.penalty),
    real("energy/imbalance", "J/m", "work less stored and dissipated energy", |r| &mut r.energy.imbalance),
];

/// Where the far ends of mounts are.
#[rustfmt::skip]
const MOUNTS: &[Column] = &[
    real("mount_normal", "m", "approach of the far end of the normal mount", |r| &mut r.mount_normal),
    along("mount_tangential", "m", "sliding of the far end of the tangential mount", [|r| &mut r.mount_tangential, |r| &mut r.across.mount_tangential]),
];

/// What mounts add to the energy balance.
#[rustfmt::skip]
const MOUNT_ENERGY: &[Column] = &[
    real("energy/mount_spring", "J/m", "energy stored in the springs of the mounts", |r| &mut r.energy.mounts.spring),
    real("energy/mount_dashpot", "J/m", "energy dissipated in the dashpots of the mounts since t = 0", |r| &mut r.energy.mounts.dashpot),
    real("energy/kinetic", "J/m", "kinetic energy of the masses of the mounts", |r| &mut r.energy.mounts.kinetic),
];

/// What has worn off.
const WORN: Column = real("worn_volume", "m^2", "volume that has worn off, per unit thickness", |r| &mut r.worn_volume);

/// What wear takes of the energy balance.
const WEAR_ENERGY: Column =
    real("energy/wear", "J/m", "work of the pressure on what it wore off since t = 0", |r| &mut r.energy.wear);

/// What adhesion takes of the energy balance.
#[rustfmt::skip]
const ADHESION_ENERGY: &[Column] = &[
    real("energy/adhesion", "J/m", "energy stored in the attraction, 0 at t = 0", |r| &mut r.energy.adhesion),
    real("energy/jumps", "J/m", "work of the attraction on the gaps beyond what it stored, since t = 0: dissipated in jumps", |r| &mut r.energy.jumps),
];

/// The temperature of the body.
#[rustfmt::skip]
const HEAT: &[Column] = &[
    real("max_temperature", "K", "highest temperature of the body", |r| &mut r.heat.highest),
    real("mean_temperature", "K", "mean temperature of the body, by heat capacity", |r| &mut r.heat.mean),
];

/// The balance of heat.
#[rustfmt::skip]
const HEAT_ENERGY: &[Column] = &[
    real("energy/heat", "J/m", "heat that entered the body since t = 0", |r| &mut r.heat.energy.entered),
    real("energy/heat_stored", "J/m", "heat that the body holds more than at t = 0", |r| &mut r.heat.energy.stored),
    real("energy/heat_convected", "J/m", "heat given to the air beside the contact since t = 0", |r| &mut r.heat.energy.convected),
    real("energy/heat_conducted", "J/m", "heat given to the base since t = 0", |r| &mut r.heat.energy.conducted),
];

/// All history columns of a run, `time` last.
pub(super) fn history(
    Extra { energy, mounts, wear, heat, adhesion, .. }: Extra,
) -> impl Iterator<Item = &'static Column> {
    let mounted = energy && mounts != [false; 2];
    let ends = MOUNTS.iter().zip(mounts).filter_map(|(column, there)| there.then_some(column));
    let energies = ENERGY.iter().filter(move |_| energy).chain(MOUNT_ENERGY.iter().filter(move |_| mounted));
    let worn = [(&WEAR_ENERGY, energy && wear), (&WORN, wear)]
        .into_iter()
        .filter_map(|(column, there)| there.then_some(column));
    let warm = HEAT_ENERGY.iter().filter(move |_| heat && energy).chain(HEAT.iter().filter(move |_| heat));
    let pulled = ADHESION_ENERGY.iter().filter(move |_| adhesion && energy);
    energies.chain(worn).chain(pulled).chain(ends).chain(warm).chain(HISTORY)
}

/// Whether a column has a component for each direction of the face.
pub fn is_vector(name: &str) -> bool {
    MOUNTS.iter().chain(HISTORY).any(|column| column.name == name && matches!(column.value, Value::Along(_)))
}

/// Units and words as they are in space, where forces and energies are not per unit thickness.
pub(super) fn in_space(units: &'static str, long_name: &str) -> (&'static str, String) {
    let units = match units {
        "N/m" => "N",
        "J/m" => "J",
        "W/m" => "W",
        "m^2" => "m^3",
        other => other,
    };
    (units, long_name.replace(", per unit thickness", "").replace(" per unit thickness", "").replace("+x", "+x and +y"))
}

impl HistoryRow {
    /// The names of the columns, as under `/history`, and its numbers; those of vectors are along x and along y.
    pub fn values(mut self, extra: Extra) -> impl Iterator<Item = (&'static str, [f64; 2])> {
        history(extra).map(move |column| match column.value {
            Value::Real(of) => (column.name, [*of(&mut self), 0.0]),
            Value::Count(of) => (column.name, [*of(&mut self) as f64, 0.0]),
            Value::Along(of) => (column.name, of.map(|of| *of(&mut self))),
        })
    }

    /// The first column whose number is not finite.
    pub fn not_finite(self) -> Option<&'static str> {
        self.values(Extra::ALL).find(|(_, values)| values.iter().any(|value| !value.is_finite())).map(|(name, _)| name)
    }
}

impl InterfaceFrame {
    /// The first field with a number that is not finite.
    pub fn not_finite(&self) -> Option<&'static str> {
        let bad = |field: &&Field| (field.values)(self).iter().any(|value| !value.is_finite());
        interface(2, Extra::ALL).chain(IN_SPACE).find(bad).map(|field| field.name)
    }
}

/// How many components a field has, and what they are called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Components {
    /// One number.
    Scalar,
    /// One for each direction of the face; in the plane one number.
    Along,
    /// One for each axis of the body.
    Axes,
    /// Those of a symmetric tensor.
    Stress,
}

impl Components {
    /// Their names in a body of so many axes, in the order of the file.
    pub fn names(self, axes: usize) -> &'static [&'static str] {
        match (self, axes) {
            (Self::Along, 3) => &["x", "y"],
            (Self::Scalar | Self::Along, _) => &[],
            (Self::Axes, 3) => &["x", "y", "z"],
            (Self::Axes, _) => &["x", "z"],
            (Self::Stress, 3) => &["xx", "yy", "zz", "xy", "yz", "xz"],
            (Self::Stress, _) => &["xx", "zz", "yy", "xz"],
        }
    }

    /// The dataset of the same group that holds the names.
    pub fn scale(self) -> &'static str {
        match self {
            Self::Scalar => "",
            Self::Along => "direction",
            Self::Axes => "axis",
            Self::Stress => "component",
        }
    }
}

/// A field on the contact face, k x m, or k x m x components.
pub(super) struct Field {
    pub name: &'static str,
    pub units: &'static str,
    pub long_name: &'static str,
    pub components: Components,
    pub values: fn(&InterfaceFrame) -> &[f64],
}

const fn field(
    name: &'static str,
    units: &'static str,
    long_name: &'static str,
    (components, values): (Components, fn(&InterfaceFrame) -> &[f64]),
) -> Field {
    Field { name, units, long_name, components, values }
}

/// The fields of `/interface`; `time` follows them.
#[rustfmt::skip]
const INTERFACE: &[Field] = &[
    field("pressure", "Pa", "contact pressure, positive in compression", (Components::Scalar, |f| &f.pressure)),
    field("shear", "Pa", "tangential traction on the layer, positive along +x", (Components::Along, |f| &f.shear)),
    field("gap", "m", "normal gap, negative where the indenter penetrates", (Components::Scalar, |f| &f.gap)),
    field("slip_rate", "m/s", "velocity of the indenter relative to the layer along x", (Components::Along, |f| &f.slip_rate)),
];

/// Those of the plane, where each component of the displacement is a field of its own.
const IN_PLANE: &[Field] = &[
    field(
        "displacement_x",
        "m",
        "displacement of the contact face along x",
        (Components::Scalar, |f| &f.displacement_x),
    ),
    field(
        "displacement_z",
        "m",
        "displacement of the contact face along z",
        (Components::Scalar, |f| &f.displacement_z),
    ),
];

/// Those of space.
const IN_SPACE: &[Field] =
    &[field("displacement", "m", "displacement of the contact face", (Components::Axes, |f| &f.displacement))];

/// Where something wears.
const WORN_DEPTH: Field = field(
    "worn_depth",
    "m",
    "depth that has worn off; of an indenter at this place of its own frame",
    (Components::Scalar, |f| &f.worn_depth),
);

/// Where the indenter wears.
const WORN_PROFILE: Field = field(
    "worn_profile",
    "m",
    "elevation of the worn indenter at this place of its own frame",
    (Components::Scalar, |f| &f.worn_profile),
);

/// Those of a body whose temperature is modelled.
#[rustfmt::skip]
const OF_HEAT: &[Field] = &[
    field("temperature", "K", "temperature of the contact face", (Components::Scalar, |f| &f.temperature)),
    field("heat_flux", "W/m^2", "heat that enters the body through the face, less what the air takes", (Components::Scalar, |f| &f.heat_flux)),
];

/// The fields of the face of a body of so many axes.
pub(super) fn interface(axes: usize, extra: Extra) -> impl Iterator<Item = &'static Field> {
    let worn = [(&WORN_DEPTH, extra.wear), (&WORN_PROFILE, extra.worn_profile)];
    let worn = worn.into_iter().filter_map(|(field, there)| there.then_some(field));
    let of_heat = OF_HEAT.iter().filter(move |_| extra.heat);
    INTERFACE.iter().chain(if axes == 3 { IN_SPACE } else { IN_PLANE }).chain(worn).chain(of_heat)
}

/// A nodal field of the bulk, j x nodes x components.
pub(super) struct BulkField {
    pub name: &'static str,
    pub units: &'static str,
    pub long_name: &'static str,
    pub components: Components,
}

/// The nodal fields of `/bulk` that all have.
#[rustfmt::skip]
const BULK: &[BulkField] = &[
    BulkField { name: "displacement", units: "m", long_name: "displacement", components: Components::Axes },
    BulkField { name: "stress", units: "Pa", long_name: "Cauchy stress at the nodes, tension positive", components: Components::Stress },
];

/// Of a body whose temperature is modelled.
const BULK_HEAT: &[BulkField] =
    &[BulkField { name: "temperature", units: "K", long_name: "temperature", components: Components::Scalar }];

/// The nodal fields of `/bulk`; `time` follows them.
pub(super) fn bulk(extra: Extra) -> impl Iterator<Item = &'static BulkField> {
    BULK.iter().chain(BULK_HEAT.iter().filter(move |_| extra.heat))
}

impl BulkField {
    /// Numbers of a node in a body of so many axes.
    pub fn width(&self, axes: usize) -> usize {
        self.components.names(axes).len().max(1)
    }
}
