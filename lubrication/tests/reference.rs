//! Two-sphere functions against published and independently computed values.

use lubrication::two_sphere::{Function, TwoSphere, named};

/// Multipole collocation, 10 digits, in the order of `named`: (ratio, gap over the smaller radius, functions).
#[rustfmt::skip]
const COLLOCATION: [(f64, f64, [f64; 44]); 4] = [
    (1.0, 1e-4, [
        2503.0677246, -2502.4225774, -2502.4225774, 2503.0677246, 2.5333916844, -1.8087219643, -1.8087219643,
        2.5333916844, -2.0637616048, 2.3010489505, -2.3010489505, 2.0637616048, 1.051692324, -0.15013922731,
        -0.15013922731, 1.051692324, 2.5451177391, 0.43313816709, 0.43313816709, 2.5451177391, 3752.6394432,
        -3752.9132897, 3752.9132897, -3752.6394432, 1.0103063226, -1.0489475014, 1.0489475014, -1.0103063226,
        0.15625246929, 0.89173787209, 0.89173787209, 0.15625246929, 1501.9608502, 1501.0975822, 1501.0975822,
        1501.9608502, 1.989795797, 0.068784212003, 0.068784212003, 1.989795797, 1.025025694, -0.072233409487,
        -0.072233409487, 1.025025694]),
    (1.0, 0.0529645959967227, [
        6.3873615313, -5.7391568413, -5.7391568413, 6.3873615313, 1.4938402252, -0.76465489427, -0.76465489427,
        1.4938402252, -0.53037949212, 0.75980518621, -0.75980518621, 0.53037949212, 1.035651876, -0.12872692313,
        -0.12872692313, 1.035651876, 1.3334198012, 0.12873886436, 0.12873886436, 1.3334198012, 7.6541444836,
        -7.9243611063, 7.9243611063, -7.6541444836, 0.2442265546, -0.28069323859, 0.28069323859, -0.2442265546,
        0.012293784561, 0.27524657642, 0.27524657642, 0.012293784561, 3.973571156, 3.1141143184, 3.1141143184,
        3.973571156, 1.2487069688, -0.096406165709, -0.096406165709, 1.2487069688, 1.0160344539, -0.058633008082,
        -0.058633008082, 1.0160344539]),
    (2.0, 1e-4, [
        4447.9594924, -2965.0631787, -2965.0631787, 2224.6636501, 3.1802118804, -1.7441071698, -1.7441071698,
        2.1589765151, -2.1628635811, 1.071190563, -3.5008090032, 1.8031784718, 1.0938594966, -0.10546770157,
        -0.10546770157, 1.0207547414, 3.0485563663, 0.34506224436, 0.34506224436, 2.1311160969, 6667.8099237,
        -2963.5889489, 5930.6212776, -3335.8200073, 1.8075357488, -0.82553718806, 1.2616667735, -0.67582162459,
        -0.056712471326, 0.86428685695, 0.55932808348, 0.2650324485, 2667.3507375, 1580.8236366, 1580.8236366,
        1335.4725298, 3.1616341816, 0.22085446083, 0.22085446083, 1.4622896516, 1.0636988787, -0.057703300215,
        -0.057703300215, 1.0094236815]),
    (2.0, 0.275945932292243, [
        2.9710996905, -1.7157437994, -1.7157437994, 2.1473882491, 1.3497647326, -0.50277717968, -0.50277717968,
        1.2322671114, -0.20932900163, 0.189691918, -0.75397471799, 0.27179333927, 1.0278797571, -0.070479409125,
        -0.070479409125, 1.009172717, 1.1353915318, 0.053862305568, 0.053862305568, 1.1313258195, 2.2052708905,
        -1.0954832759, 3.1744584308, -1.6303633404, 0.16588129892, -0.091765568395, 0.19652034191, -0.082711962192,
        -0.022610809207, 0.12600752862, 0.10763202876, 0.019026601308, 1.7564173269, 0.63481334508, 0.63481334508,
        1.6308364854, 1.1856054547, -0.049566973462, -0.049566973462, 1.0561682792, 1.0185799842, -0.032311348836,
        -0.032311348836, 1.0029144368]),
];

#[test]
fn resistance_agrees_with_collocation() {
    for (ratio, gap, expected) in COLLOCATION {
        let found = TwoSphere::with_ratio(ratio).unwrap().resistance(gap).unwrap();
        for ((name, found), expected) in named(&found).into_iter().zip(expected) {
            // Accuracy of the printed digits and of the collocation.
            assert!((found / expected - 1.0).abs() < 5e-10, "{name} ratio {ratio} gap {gap}: {found}, not {expected}");
        }
    }
}

/// Multipole collocation: ratio 2; gap; xa11, xa12, xa22, ya11, ya12, ya22, yb11, yb12, yb21, yb22 as velocity times
/// `6 pi` over force.
#[rustfmt::skip]
const MOBILITIES: [(f64, [f64; 10]); 2] = [
    (2.0000000000131e-05, [
        0.476845476157877, 0.476808308242759, 0.476816132422179, 0.819774262850909, 0.333997035437239,
        0.477164501754607, -0.123365878621174, 0.0616016977464108, -0.115461490976037, 0.0219878942654397]),
    (1.6, [
        0.932417370800647, 0.303577845691467, 0.494383443789253, 0.995698898978495, 0.175922646294596,
        0.499778279499221, -0.00122447474117206, 0.035409383222011, -0.0355021500269013, 0.000219510881059027]),
];

#[test]
fn mobility_agrees_with_collocation() {
    let table = TwoSphere::with_ratio(2.0).unwrap();
    for (gap, [a11, a12, a22, b11, b12, b22, yb11, yb12, yb21, yb22]) in MOBILITIES {
        let found = table.mobility(gap).unwrap();
        let (xa, ya, yb) = (found[Function::XA], found[Function::YA], found[Function::YB]);
        let pairs = [
            (xa[0][0], a11),
            (xa[0][1] / 1.5, a12),
            (xa[1][1] / 2.0, a22),
            (ya[0][0], b11),
            (ya[0][1] / 1.5, b12),
            (ya[1][1] / 2.0, b22),
            // A rotation about y is minus b times the force along x.
            (-yb[0][0] * 6.0 / 4.0, yb11),
            (-yb[0][1] * 6.0 / 9.0, yb12),
            (-yb[1][0] * 6.0 / 9.0, yb21),
            (-yb[1][1] * 6.0 / 16.0, yb22),
        ];
        for (found, expected) in pairs {
            // Ten digits of a resistance of 1e5 leave seven of the mobility at the small gap.
            assert!((found / expected - 1.0).abs() < 1e-7, "gap {gap}: {found}, not {expected}");
        }
    }
}

/// Stresslets of a force- and torque-free pair over those of single spheres, ratio 2, gap 2e-6; multipole collocation.
#[test]
fn stresslets_in_strain_agree_with_collocation() {
    let found = TwoSphere::with_ratio(2.0).unwrap().mobility(2e-6).unwrap();
    let expected = [
        (Function::XM, [2.76954474403314, 1.19904217831378]),
        (Function::YM, [1.78793959975598, 1.02902864905018]),
        (Function::ZM, [0.868932851061459, 0.985078415177094]),
    ];
    for (function, stresslets) in expected {
        let m = found[function];
        let sums = [m[0][0] + m[0][1] * 1.5_f64.powi(3), m[1][1] + m[1][0] * 0.75_f64.powi(3)];
        for (sum, stresslet) in sums.into_iter().zip(stresslets) {
            assert!((sum / stresslet - 1.0).abs() < 1e-7, "{function:?}: {sum}, not {stresslet}");
        }
    }
}

/// Batchelor & Green's A and B from mobility g and h, equal spheres; multipole collocation.
#[test]
fn relative_motion_in_strain_agrees_with_collocation() {
    let table = TwoSphere::with_ratio(1.0).unwrap();
    for (gap, a, b) in [(1e-6, 0.999995922641431, 0.343154113329274), (0.25, 0.526690900327873, 0.100137932741242)] {
        let found = table.mobility(gap).unwrap();
        let distance = 2.0 + gap;
        // Mean radius 1; a unit strain rate along the line of centres moves a sphere by g, one normal to it by 2 g.
        let (xg, yg) = (found[Function::XG], found[Function::YG]);
        let relative = |g: [[f64; 2]; 2]| g[0][1] + g[1][1] - g[0][0] - g[1][0];
        let along = relative(xg);
        let across = 2.0 * relative(yg);
        assert!((-along / distance - a).abs() < 1e-8, "gap {gap}: A is {}, not {a}", -along / distance);
        assert!((-across / distance - b).abs() < 1e-8, "gap {gap}: B is {}, not {b}", -across / distance);
    }
}

/// Constants of the near-contact expansion, equal spheres: Jeffrey & Onishi (1984), Jeffrey (1992), tables in Kim &
/// Karrila (1991), ch. 11.
#[test]
fn near_contact_constants_are_the_published_ones() {
    let functions = TwoSphere::with_ratio(1.0).unwrap().resistance(1e-7).unwrap();
    let (xi, log) = (1e-7_f64, -(1e-7_f64.ln()));
    let expected = [
        (Function::XA, [0.9954 + 0.25 / xi + 0.225 * log, -0.3502 - 0.25 / xi - 0.225 * log]),
        (Function::YA, [0.9983 + log / 6.0, -0.2737 - log / 6.0]),
        (Function::YB, [0.2390 - 0.25 * log, -0.0017 + 0.25 * log]),
        (Function::XC, [1.0518, -0.1503]),
        (Function::YC, [0.7028 + 0.2 * log, -0.0274 + 0.05 * log]),
    ];
    for (function, [own, other]) in expected {
        let found = functions[function];
        assert!((found[0][0] - own).abs() < 1e-4, "{function:?}11 is {}, not {own}", found[0][0]);
        assert!((found[0][1] - other).abs() < 1e-4, "{function:?}12 is {}, not {other}", found[0][1]);
    }
}
