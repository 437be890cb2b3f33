//! The sled: two tracks of runners on a frame that rolls and twists, and the one-track sled that is
//! closest to it.

/// Lateral law of a runner.
#[derive(Debug, Clone, Copy)]
pub struct Grip {
    /// Cornering stiffness of the axle [N/rad].
    pub stiffness_n_per_rad: f64,
    /// Largest lateral force over the load.
    pub peak: f64,
    /// How sharply the force bends from one to the other.
    pub exponent: f64,
}

impl Grip {
    /// Lateral force [N] at a slip angle [rad] and a load [N]:
    ///
    /// ```text
    /// F = K alpha (1 + |K alpha/(mu N)|^p)^(-1/p)
    /// ```
    ///
    /// `K` is `share` of the axle's stiffness. With p = 1.8 it is within 1 % of the peak from a
    /// magic formula; with p = 1 it is a hyperbola, with p = 3 nearly two straight lines.
    pub fn force(&self, share: f64, slip_rad: f64, load_n: f64) -> f64 {
        let linear = share * self.stiffness_n_per_rad * slip_rad;
        let over = (linear / (self.peak * load_n.max(1.0))).abs();
        linear * (1.0 + over.powf(self.exponent)).powf(-1.0 / self.exponent)
    }

    /// `mu_zeta` of the magic formula with this stiffness, the shape factor `c` and the curvature
    /// factor `e` that has the same force at a slip of 1.5 times peak over stiffness.
    ///
    /// By bisection; the formula grows with `mu_zeta`.
    pub fn mu_zeta(&self, c: f64, e: f64) -> f64 {
        let reduced = 1.5 * self.peak;
        let formula = |mu_zeta: f64| {
            let x = reduced / (c * mu_zeta);
            mu_zeta * (c * (x - e * (x - x.atan())).atan()).sin()
        };
        let wanted = reduced * (1.0 + 1.5_f64.powf(self.exponent)).powf(-1.0 / self.exponent);
        let [mut low, mut high] = [0.3, 4.0].map(|times| times * self.peak / c);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if formula(middle) < wanted {
                &mut low
            } else {
                &mut high
            }) = middle;
        }
        0.5 * (low + high)
    }
}

/// Shape and curvature factor of the stated magic formulas, front and rear.
const SHAPES: [[f64; 2]; 2] = [[0.024, 0.99], [0.076, 0.99]];

/// The true sled; places from the centre of gravity.
#[derive(Debug, Clone, Copy)]
pub struct Sled {
    /// Mass of sled and crew [kg].
    pub mass_kg: f64,
    /// Pitch inertia [kg m2].
    pub j_yy_kgm2: f64,
    /// Yaw inertia [kg m2].
    pub j_zz_kgm2: f64,
    /// Roll inertia of body and front part [kg m2].
    pub j_xx_kgm2: [f64; 2],
    /// Front axle ahead, rear axle behind [m].
    pub axle_m: [f64; 2],
    /// Half the distance of the runners of an axle [m].
    pub half_track_m: f64,
    /// Centre of gravity above the ice [m].
    pub height_m: f64,
    /// Joint of the front part above the ice [m].
    pub joint_m: f64,
    /// Roll stiffness and damping of the front and rear runners in their mounts [N m/rad, N m s].
    pub mounts: [[f64; 2]; 2],
    /// Stiffness and damping of the frame in torsion [N m/rad, N m s].
    pub torsion: [f64; 2],
    /// Steering angle that a lateral force takes back [rad/N].
    pub compliance_rad_per_n: f64,
    /// Play of the steering from stop to stop [rad].
    pub play_rad: f64,
    /// Alignment of the runners: front left, front right, rear left, rear right [rad].
    pub toe_rad: [f64; 4],
    /// Drag area [m2].
    pub cda_m2: f64,
    /// Its growth with drift [1/deg].
    pub yaw_drag_per_deg: f64,
    /// Friction along the runners.
    pub mu: f64,
    /// Lateral laws, front and rear.
    pub grip: [Grip; 2],
    /// Accelerometer [m].
    pub accel_m: [f64; 3],
    /// Slip sensor, forward positive [m].
    pub slip_m: f64,
}

/// A lateral force that takes up the play to three quarters [N].
pub const PLAY_FORCE_N: f64 = 20.0;

impl Sled {
    /// A two-man sled; steering compliance, play and alignment are ideal.
    pub fn ideal() -> Self {
        let grip = |stiffness_n_per_rad, peak| Grip {
            stiffness_n_per_rad,
            peak,
            exponent: 1.8,
        };
        Self {
            mass_kg: 382.0,
            j_yy_kgm2: 138.0,
            j_zz_kgm2: 156.0,
            j_xx_kgm2: [26.0, 3.0],
            axle_m: [0.80, 0.90],
            half_track_m: 0.335,
            height_m: 0.28,
            joint_m: 0.12,
            mounts: [[9e4, 400.0], [16e4, 900.0]],
            torsion: [0.0, 60.0],
            compliance_rad_per_n: 0.0,
            play_rad: 0.0,
            toe_rad: [0.0; 4],
            cda_m2: 0.27,
            yaw_drag_per_deg: 0.06,
            mu: 0.0045,
            grip: [grip(11_500.0, 0.065), grip(46_000.0, 0.26)],
            accel_m: [-0.30, 0.0, 0.10],
            slip_m: -0.70,
        }
    }

    /// Steering angle that a lateral force on the front runners takes back [rad].
    ///
    /// `c F + (w/2) tanh(F/F_0)`: the force presses the steering against one side of its play.
    pub fn yield_rad(&self, force_n: f64, added_play_rad: f64) -> f64 {
        let half = 0.5 * (self.play_rad + added_play_rad);
        self.compliance_rad_per_n * force_n + half * (force_n / PLAY_FORCE_N).tanh()
    }

    /// The sled with its centre of gravity further ahead [m]: axles and sensors move back.
    pub fn centre_ahead(&mut self, by: f64) {
        self.axle_m[0] -= by;
        self.axle_m[1] += by;
        self.accel_m[0] -= by;
        self.slip_m -= by;
    }

    /// Cornering stiffness and `mu_zeta` of the axles of a rigid sled with one track.
    ///
    /// Runners side by side add up. A compliant steering is a spring in series:
    /// `1/K = 1/K_ice + c`. Play, roll, torsion and load transfer have no counterpart.
    pub fn one_track(&self) -> [[f64; 2]; 2] {
        let compliance = [self.compliance_rad_per_n, 0.0];
        std::array::from_fn(|axle| {
            let grip = &self.grip[axle];
            let [c, e] = SHAPES[axle];
            let stiffness = 1.0 / (1.0 / grip.stiffness_n_per_rad + compliance[axle]);
            [stiffness, grip.mu_zeta(c, e)]
        })
    }

    /// The model file's `[sled]` and `[friction]` of a one-track sled with this friction: `mu`,
    /// stiffness [N/rad] and `mu_zeta` of the axles.
    pub fn model(&self, mu: f64, lateral: [[f64; 2]; 2]) -> String {
        let [x, y, z] = self.accel_m;
        let mut text = format!(
            "[sled]\nmass_kg = {:.2}\nj_yy_kgm2 = {:.2}\nj_zz_kgm2 = {:.2}\nl_f_m = {:.4}\n\
             l_r_m = {:.4}\naccel_x_m = {x:.4}\naccel_y_m = {y:.4}\naccel_z_m = {z:.4}\n\
             slip_x_m = {:.4}\ncda_m2 = {:.4}\nyaw_drag_per_deg = {:.4}\n\n\
             [friction.longitudinal]\nmu = {mu:.6}\n",
            self.mass_kg,
            self.j_yy_kgm2,
            self.j_zz_kgm2,
            self.axle_m[0],
            self.axle_m[1],
            self.slip_m,
            self.cda_m2,
            self.yaw_drag_per_deg,
        );
        for axle in [0, 1] {
            let ([stiffness, mu_zeta], [c, e]) = (lateral[axle], SHAPES[axle]);
            text += &format!(
                "\n[friction.{}]\nmu_zeta = {mu_zeta:.5}\nc = {c}\ne = {e}\nk_n_per_rad = {stiffness:.2}\n",
                ["front", "rear"][axle],
            );
        }
        text
    }

    /// The same sled for the inversion of residuals.
    pub fn inverted(&self, mu: f64, lateral: [[f64; 2]; 2]) -> crate::world::sled::Sled {
        let law = |axle: usize| crate::world::sled::Lateral {
            mu_zeta: lateral[axle][1],
            c: SHAPES[axle][0],
            e: SHAPES[axle][1],
            k_n_per_rad: lateral[axle][0],
        };
        crate::world::sled::Sled {
            mass_kg: self.mass_kg,
            j_yy_kgm2: self.j_yy_kgm2,
            j_zz_kgm2: self.j_zz_kgm2,
            l_f_m: self.axle_m[0],
            l_r_m: self.axle_m[1],
            accel_m: self.accel_m,
            slip_x_m: self.slip_m,
            cda_m2: self.cda_m2,
            yaw_drag_per_deg: self.yaw_drag_per_deg,
            mu,
            front: law(0),
            rear: law(1),
        }
    }
}
