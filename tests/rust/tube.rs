//! Tubes against solutions in closed form, and the program's inclusions against plain floats.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::cast_precision_loss, reason = "test data are small numbers")]

use interval_core::Interval;
use interval_core::tube::program::{Moving, run};
use interval_core::tube::{Cutting, Entry, Given, Inputs, Model, Node, Op, Three, follow};

fn i(lo: f64, hi: f64) -> Interval {
    Interval::new(lo, hi).expect("ordered")
}

fn p(x: f64) -> Interval {
    i(x, x)
}

/// Surge alone: m u' + d u|u| = X, or with linear drag.
fn surge(drag: Op, vertices: &[[f64; 2]]) -> Model {
    let column = |term, register, mass| Entry { term, register, inertia: [mass, 0.0, 0.0] };
    let points: Vec<Vec<Interval>> = vertices.iter().map(|v| v.iter().map(|&x| p(x)).collect()).collect();
    let hull = (0..2)
        .map(|k| {
            let all = vertices.iter().map(|v| v[k]);
            i(all.clone().fold(f64::INFINITY, f64::min), all.fold(f64::NEG_INFINITY, f64::max))
        })
        .collect();
    let idle = vec![vec![p(1.0), p(1.0)]];
    Model::new(
        vec![drag],
        [vec![column(0, None, 1.0), column(1, Some(3), 0.0)], Vec::new(), Vec::new()],
        [points, idle.clone(), idle],
        hull,
        [true, false, false],
    )
    .expect("a model")
}

fn node(u: Interval) -> Node {
    Node { nu: [u, Interval::ZERO, Interval::ZERO], pose: [Interval::ZERO; 3] }
}

fn tube(model: &Model, start: Interval, force: &[Interval], h: f64, parts: u32) -> Vec<Interval> {
    let steps = vec![p(h); force.len()];
    let zero = vec![Interval::ZERO; force.len()];
    let given = vec![Given { nu: [Interval::ZERO; 3], rates: [Interval::ZERO; 3] }; force.len()];
    let inputs = Inputs { h: &steps, force: [force, &zero, &zero], given: &given };
    let found = follow(model, node(start), &inputs, parts, None, true).expect("fits");
    assert_eq!(found.nodes.len(), force.len() + 1, "a box over every step");
    assert_eq!(found.parts.len() % parts as usize, 0);
    found.nodes.iter().map(|n| n.nu[0]).collect()
}

/// u' = (X - a u) / m: the ends of the tube are the solutions of the extreme members.
#[test]
fn linear_drag_has_its_closed_form() {
    let linear = surge(Op::Add(0, 0), &[[10.0, 2.0]]); // the column is 2 u
    let (h, x) = (0.05, i(3.0, 5.0));
    let found = tube(&linear, i(0.1, 0.2), &[x; 400], h, 1);
    for (k, u) in found.iter().enumerate() {
        let decay = (-0.4 * h * k as f64).exp();
        let exact = |start: f64, force: f64| start * decay + force / 4.0 * (1.0 - decay);
        let (low, high) = (exact(0.1, 3.0), exact(0.2, 5.0));
        assert!(u.lo() <= low + 1e-14 && high <= u.hi() + 1e-14, "{k}: {u:?} misses [{low}, {high}]");
        assert!(u.width() <= 1.001 * (high - low), "{k}: {u:?} is wide beside [{low}, {high}]");
    }
}

/// m u' = X - d u|u| from rest is tanh; from a speed without thrust it is a hyperbola.
#[test]
fn quadratic_drag_has_its_closed_form() {
    let model = surge(Op::SignedSquare(0), &[[60.0, 255.0]]);
    let h = 0.05;
    let found = tube(&model, Interval::ZERO, &[p(40.0); 200], h, 1);
    let (last, rate) = ((40.0_f64 / 255.0).sqrt(), (40.0_f64 * 255.0).sqrt() / 60.0);
    for (k, u) in found.iter().enumerate() {
        let exact = last * (rate * h * k as f64).tanh();
        assert!(u.lo() <= exact + 1e-15 && exact <= u.hi() + 1e-15, "{k}: {u:?} misses {exact}");
        assert!(u.width() <= 2.5e-3, "{k}: {u:?}");
    }
    // The error of a step is of third order, that of the tube of second.
    let widest =
        |parts| tube(&model, Interval::ZERO, &[p(40.0); 200], h, parts).iter().map(|u| u.width()).fold(0.0, f64::max);
    assert!(widest(4) <= widest(1) / 12.0, "{} and {}", widest(4), widest(1));
    let found = tube(&model, p(-0.8), &[Interval::ZERO; 400], h, 2);
    for (k, u) in found.iter().enumerate() {
        let exact = -1.0 / (1.0 / 0.8 + 255.0 / 60.0 * h * k as f64);
        assert!(u.contains(exact) || (u.lo() - exact).abs().min((u.hi() - exact).abs()) < 1e-15, "{k}: {u:?}");
        assert!(u.width() <= 5e-3, "{k}: {u:?}");
    }
}

/// Both ends of a tube over a set of parameters are attained where one vertex is extreme throughout.
#[test]
fn vertices_that_are_extreme_are_attained() {
    let model = surge(Op::SignedSquare(0), &[[50.0, 240.0], [70.0, 240.0], [50.0, 270.0], [70.0, 270.0]]);
    let found = tube(&model, Interval::ZERO, &[i(39.0, 41.0); 400], 0.05, 1);
    let last = found[400];
    let (low, high) = ((39.0_f64 / 270.0).sqrt(), (41.0_f64 / 240.0).sqrt());
    assert!(last.lo() <= low && high <= last.hi());
    assert!(last.width() <= 1.0001 * (high - low), "{last:?}");
}

/// A box twice as wide gives a tube at most 2.5 times as wide, and steps of half the length a narrower one.
#[test]
fn widths_grow_with_the_box() {
    let widest = |radius: f64, parts: u32| {
        let v = [1.0 - radius, 1.0 + radius];
        let corners: Vec<[f64; 2]> = v.iter().flat_map(|a| v.iter().map(move |b| [60.0 * a, 255.0 * b])).collect();
        let model = surge(Op::SignedSquare(0), &corners);
        let force: Vec<Interval> = (0..2000).map(|k| p(if k / 100 % 2 == 0 { 60.0 } else { 10.0 })).collect();
        tube(&model, Interval::ZERO, &force, 0.05, parts).iter().map(|u| u.width()).fold(0.0, f64::max)
    };
    assert!(widest(0.1, 1) <= 2.5 * widest(0.05, 1));
    assert!(widest(0.05, 4) < widest(0.05, 1));
}

/// m (u' - v r) = 0, m (v' + u r) = 0, I r' = 0: the velocity turns in the body at -r.
fn rotating(hull: Vec<Interval>, vertices: &[Vec<Interval>]) -> Model {
    let program = vec![Op::Mul(1, 2), Op::Neg(3), Op::Mul(0, 2)];
    let entry = |term, register, k: usize| Entry {
        term,
        register,
        inertia: std::array::from_fn(|j| if j == k { 1.0 } else { 0.0 }),
    };
    let channels = [vec![entry(0, Some(4), 0)], vec![entry(0, Some(5), 1)], vec![entry(1, None, 2)]];
    Model::new(program, channels, std::array::from_fn(|_| vertices.to_vec()), hull, [true; 3]).expect("fits")
}

/// Three channels with a rotation that keeps the speed: no solution leaves the tube, by its closed form.
#[test]
fn a_rotation_is_held() {
    let vertices = vec![vec![p(50.0), p(7.0)], vec![p(50.0), p(9.0)]];
    let model = rotating(vec![p(50.0), i(7.0, 9.0)], &vertices);
    let n = 200;
    let (steps, zero) = (vec![p(0.05); n], vec![Interval::ZERO; n]);
    let inputs = Inputs { h: &steps, force: [&zero, &zero, &zero], given: &[] };
    let start = Node { nu: [p(0.5), p(0.1), p(0.3)], pose: [Interval::ZERO; 3] };
    let found = follow(&model, start, &inputs, 1, None, false).expect("fits");
    assert_eq!(found.nodes.len(), n + 1);
    for (k, node) in found.nodes.iter().enumerate() {
        let angle = 0.3 * 0.05 * k as f64;
        let (s, c) = angle.sin_cos();
        let exact = [0.5 * c + 0.1 * s, 0.1 * c - 0.5 * s, 0.3];
        for j in 0..3 {
            assert!(node.nu[j].lo() <= exact[j] + 1e-14 && exact[j] <= node.nu[j].hi() + 1e-14, "{k} {j}");
            assert!(node.nu[j].width() < 0.05, "{k} {j} {:?}", node.nu[j]);
        }
        // The velocity over ground is constant: north 0.5 t, east 0.1 t, heading 0.3 t.
        let t = 0.05 * k as f64;
        for (j, x) in [0.3 * t, 0.5 * t, 0.1 * t].into_iter().enumerate() {
            assert!(node.pose[j].lo() <= x + 1e-13 && x <= node.pose[j].hi() + 1e-13, "{k} {j} {:?}", node.pose[j]);
            assert!(node.pose[j].width() < 0.3, "{k} {j} {:?}", node.pose[j]);
        }
    }
}

/// m (u' - v r) + d u|u| = X, m (v' + u r) + d v|v| = Y, I r' = N, with I in a range.
fn turning(drag: f64) -> Model {
    let program = vec![Op::Mul(1, 2), Op::Neg(3), Op::Mul(0, 2), Op::SignedSquare(0), Op::SignedSquare(1)];
    let entry = |term, register, k: usize| Entry {
        term,
        register,
        inertia: std::array::from_fn(|j| if j == k { 1.0 } else { 0.0 }),
    };
    let channels = [
        vec![entry(0, Some(4), 0), entry(1, Some(6), 3)],
        vec![entry(0, Some(5), 1), entry(1, Some(7), 3)],
        vec![entry(2, None, 2)],
    ];
    let vertex = vec![vec![p(50.0), p(drag), p(7.0)], vec![p(50.0), p(drag), p(9.0)]];
    let hull = vec![p(50.0), p(drag), i(7.0, 9.0)];
    Model::new(program, channels, [vertex.clone(), vertex.clone(), vertex], hull, [true; 3]).expect("fits")
}

/// An inertia does not change on the way: where the moment changes its sign, the extremes of the yaw rate are those of one
/// inertia, and a moment's error counts as its integral.
#[test]
fn one_inertia_turns_the_whole_way() {
    let model = turning(250.0);
    let n = 400;
    let moment: Vec<Interval> = (0..n).map(|k| if k / 50 % 2 == 0 { i(1.9, 2.1) } else { i(-2.1, -1.9) }).collect();
    let (steps, zero) = (vec![p(0.05); n], vec![Interval::ZERO; n]);
    let inputs = Inputs { h: &steps, force: [&zero, &zero, &moment], given: &[] };
    let found = follow(&model, node(Interval::ZERO), &inputs, 1, None, false).expect("fits");
    assert_eq!(found.nodes.len(), n + 1);
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    for (k, node) in found.nodes.iter().enumerate() {
        let ends = [low / 7.0, low / 9.0, high / 7.0, high / 9.0];
        let (least, most) = (ends.into_iter().fold(f64::INFINITY, f64::min), ends.into_iter().fold(-1e9, f64::max));
        assert!(node.nu[2].lo() <= least + 1e-12 && most <= node.nu[2].hi() + 1e-12, "{k}: {:?}", node.nu[2]);
        assert!(node.nu[2].width() <= 1.000_001 * (most - least) + 1e-12, "{k}: {:?}", node.nu[2]);
        if let Some(n) = moment.get(k) {
            (low, high) = (low + 0.05 * n.lo(), high + 0.05 * n.hi());
        }
    }
}

/// A turn does no work: speeds stay below what the force drives against the drag, at any yaw rate.
#[test]
fn a_turn_of_any_rate_does_no_work() {
    let model = turning(250.0);
    let n = 200;
    let (steps, zero, push) = (vec![p(0.05); n], vec![Interval::ZERO; n], vec![i(-20.0, 20.0); n]);
    let inputs = Inputs { h: &steps, force: [&push, &zero, &zero], given: &[] };
    let start = Node { nu: [i(0.2, 0.3), i(-0.1, 0.1), i(-4.0, 4.0)], pose: [Interval::ZERO; 3] };
    let found = follow(&model, start, &inputs, 1, None, false).expect("fits");
    assert_eq!(found.nodes.len(), n + 1);
    // Drag along the motion is at least d |nu|^2 / sqrt 2.
    let most = (20.0 * 2.0_f64.sqrt() / 250.0).sqrt();
    for node in &found.nodes {
        assert!(node.nu[0].magnitude() <= 1.3 * most && node.nu[1].magnitude() <= 1.3 * most, "{:?}", node.nu);
    }
    let last = &found.nodes[n].nu;
    let held = (20.0_f64 / 250.0).sqrt() * (20.0_f64 * 250.0).sqrt().mul_add(10.0 / 50.0, 0.0).tanh();
    assert!(last[0].hi() >= held && last[0].lo() <= -held, "{last:?}");
}

/// A mass that may vanish has no accelerations, and a drag that drives blows up in finite time: the tube ends before.
#[test]
fn no_box_no_bound() {
    let may_vanish = surge(Op::SignedSquare(0), &[[-1.0, 200.0], [60.0, 200.0]]);
    let steps = [p(0.05); 3];
    let zero = [Interval::ZERO; 3];
    let given = [Given { nu: [Interval::ZERO; 3], rates: [Interval::ZERO; 3] }; 3];
    let inputs = Inputs { h: &steps, force: [&[p(1.0); 3], &zero, &zero], given: &given };
    assert_eq!(follow(&may_vanish, node(Interval::ZERO), &inputs, 1, None, false).expect("fits").nodes.len(), 1);
    // u' = u^2 from 1 ends at t = 1.
    let drives = surge(Op::Square(0), &[[1.0, -1.0]]);
    let (steps, zero) = (vec![p(0.01); 300], vec![Interval::ZERO; 300]);
    let given = vec![given[0]; 300];
    let inputs = Inputs { h: &steps, force: [&zero, &zero, &zero], given: &given };
    let found = follow(&drives, node(p(1.0)), &inputs, 1, None, false).expect("fits");
    assert!((80..=101).contains(&found.nodes.len()), "{}", found.nodes.len());
    for (k, n) in found.nodes.iter().enumerate() {
        assert!(n.nu[0].hi() >= 1.0 / (1.0 - 0.01 * k as f64) - 1e-12);
    }
}

/// Values and rates of every operation hold those of plain floats and of difference quotients.
#[test]
fn programs_include_their_floats() {
    let half = 0.55;
    let program = vec![
        Op::Constant(0.3),
        Op::Add(0, 1),
        Op::Sub(1, 2),
        Op::Mul(4, 5),
        Op::Neg(6),
        Op::Abs(5),
        Op::Square(4),
        Op::SignedSquare(5),
        Op::Cube(5),
        Op::Tanh(4),
        Op::AsternSquare(5),
        Op::CrossFlowForce(1, 2, half),
        Op::CrossFlowMoment(1, 2, half),
    ];
    let mut seed = 1_u64;
    let mut draw = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    for _ in 0..2000 {
        let centre = [draw(), draw(), draw()];
        let reach = [0.3 * draw().abs(), 0.3 * draw().abs(), 0.3 * draw().abs()];
        let direction = [draw(), draw(), draw()];
        let inside: [f64; 3] = std::array::from_fn(|k| centre[k] + reach[k] * draw());
        let span: Three = std::array::from_fn(|k| i(centre[k] - reach[k], centre[k] + reach[k]));
        let mut ranges = span.to_vec();
        run(&program, &mut ranges);
        let mut moving: Vec<Moving> = (0..3).map(|k| Moving { value: span[k], rate: p(direction[k]) }).collect();
        run(&program, &mut moving);
        let at = |t: f64| {
            let mut x: Vec<f64> = (0..3).map(|k| inside[k] + t * direction[k]).collect();
            run(&program, &mut x);
            x
        };
        let (x, step) = (at(0.0), 1e-6);
        let (before, after) = (at(-step), at(step));
        for k in 3..x.len() {
            let op = program[k - 3];
            assert!(ranges[k].lo() - 1e-14 <= x[k] && x[k] <= ranges[k].hi() + 1e-14, "{op:?} {x:?} {:?}", ranges[k]);
            assert_eq!(ranges[k], moving[k].value, "{op:?}");
            let slope = (after[k] - before[k]) / (2.0 * step);
            // Points beside the box belong to the quotient alone.
            assert!(
                moving[k].rate.lo() - 1e-4 <= slope && slope <= moving[k].rate.hi() + 1e-4,
                "{op:?} {slope} {:?}",
                moving[k].rate
            );
        }
        // The integrals along the hull by the midpoint rule.
        let (v, r) = (inside[1], inside[2]);
        let (mut force, mut moment, cells) = (0.0, 0.0, 2000);
        for c in 0..cells {
            let s = half * (2.0 * (f64::from(c) + 0.5) / f64::from(cells) - 1.0);
            let w = v + s * r;
            force += w * w.abs() * 2.0 * half / f64::from(cells);
            moment += s * w * w.abs() * 2.0 * half / f64::from(cells);
        }
        assert!((x[14] - force).abs() < 1e-5 && (x[15] - moment).abs() < 1e-5, "{x:?} {force} {moment}");
    }
}

/// Turns of any rate in a range: each solution is held by its closed form, and cells of the rate are narrower than one box.
#[test]
fn cells_of_the_yaw_rate_hold_every_turn() {
    let hull = vec![p(50.0), p(8.0)];
    let model = rotating(hull.clone(), &[hull]);
    let n = 30;
    let (steps, zero) = (vec![p(0.05); n], vec![Interval::ZERO; n]);
    let inputs = Inputs { h: &steps, force: [&zero, &zero, &zero], given: &[] };
    let (least, most) = (-0.4, 0.8);
    let start = Node { nu: [p(0.5), p(0.1), i(least, most)], pose: [Interval::ZERO; 3] };
    let tube = |cutting| follow(&model, start, &inputs, 1, cutting, true).expect("fits");
    let cutting = Cutting { most: 12, every: 7, narrowest: 0.01 };
    let (whole, cells) = (tube(None), tube(Some(cutting)));
    assert!(whole.parts.iter().all(|x| x.cell == 0) && cells.parts.iter().any(|x| x.cell > 5));
    assert!(cells.parts.iter().all(|x| x.cell < 12));
    for (k, node) in cells.nodes.iter().enumerate() {
        for step in 0..=120 {
            let r = (least + (most - least) * f64::from(step) / 120.0).clamp(least, most);
            assert!(node.nu[2].contains(r), "{k} {r} {:?}", node.nu[2]);
            // The closed form in intervals: an end of the tube beyond both of its ends leaves the solution out.
            let angle = p(r) * p(0.05) * p(k as f64);
            let (s, c) = (angle.sin(), angle.cos());
            for (j, x) in [p(0.5) * c + p(0.1) * s, p(0.1) * c - p(0.5) * s].into_iter().enumerate() {
                assert!(node.nu[j].lo() <= x.hi() && x.lo() <= node.nu[j].hi(), "{k} {j} {x:?} {:?}", node.nu[j]);
            }
        }
    }
    let [one, many] = [&whole, &cells].map(|t| t.nodes[n].nu[0].width());
    assert!(many < 0.9 * one, "{many} and {one}");
    // A single rate needs no cells, and a number that is not one is refused.
    let still = Node { nu: [p(0.5), p(0.1), p(0.3)], pose: [Interval::ZERO; 3] };
    let alone = |cutting| follow(&model, still, &inputs, 1, cutting, true).expect("fits").parts.len();
    assert_eq!(alone(Some(cutting)), alone(None));
    for wrong in [
        Cutting { most: 0, ..cutting },
        Cutting { every: 0, ..cutting },
        Cutting { narrowest: 0.0, ..cutting },
        Cutting { narrowest: f64::NAN, ..cutting },
    ] {
        assert!(follow(&model, start, &inputs, 1, Some(wrong), false).is_err());
    }
}

/// Misuse is an error in words.
#[test]
fn misuse_is_an_error() {
    assert!(Op::named("sine", 0, 0, 0.0).is_err());
    let hull = vec![p(1.0)];
    let rows = || [vec![vec![p(1.0)]], vec![vec![p(1.0)]], vec![vec![p(1.0)]]];
    let none = || [Vec::new(), Vec::new(), Vec::new()];
    assert!(Model::new(vec![Op::Add(0, 9)], none(), rows(), hull.clone(), [true; 3]).is_err());
    assert!(
        Model::new(Vec::new(), none(), [rows()[0].clone(), Vec::new(), Vec::new()], hull.clone(), [true; 3]).is_err()
    );
    let wrong = [vec![Entry { term: 4, register: None, inertia: [0.0; 3] }], Vec::new(), Vec::new()];
    assert!(Model::new(Vec::new(), wrong, rows(), hull, [true; 3]).is_err());
    let model = surge(Op::SignedSquare(0), &[[60.0, 255.0]]);
    let one = [Interval::ZERO];
    let given = [Given { nu: [Interval::ZERO; 3], rates: [Interval::ZERO; 3] }];
    for (h, force, g, parts) in [
        (p(0.0), &one[..], &given[..], 1),
        (p(0.1), &[][..], &given[..], 1),
        (p(0.1), &one[..], &[][..], 1),
        (p(0.1), &one[..], &given[..], 0),
    ] {
        let inputs = Inputs { h: &[h], force: [force, &one, &one], given: g };
        assert!(follow(&model, node(Interval::ZERO), &inputs, parts, None, false).is_err());
    }
}
