//! Facts about schemes from papers and by hand.

use serde_json::{Value, json};

use super::{asked, numbers, preset, smoothness, texts, word};

fn four_point(w: &str) -> (i64, Option<i64>) {
    smoothness(&asked(&json!({ "plan": { "preset": "four-point", "parameters": { "w": w } }, "nodes": 100_000 })))
}

#[test]
fn the_four_point_scheme_is_c1_exactly_for_w_between_0_and_the_zero_of_32_w3_4_w_1() {
    let zero = |w: f64| 32.0 * w * w * w + 4.0 * w - 1.0;
    assert!(zero(0.1925) < 0.0 && zero(0.193) > 0.0, "the ends of the bracket are on both sides");
    for w in ["1/1000", "1/20", "1/16", "1/10", "0.19", "0.1925"] {
        assert_eq!(four_point(w), (1, Some(2)), "w = {w}");
    }
    for w in ["-1/100", "0", "0.193", "1/5"] {
        assert_eq!(four_point(w), (0, Some(1)), "w = {w}");
    }
}

#[test]
fn the_interpolating_cubic_scheme_is_c1_and_not_c2_as_its_radius_is_2_exactly() {
    let answer = preset("four-point", &json!({}));
    assert_eq!(smoothness(&answer), (1, Some(2)));
    assert_eq!(answer["smoothness"]["joint_spectral_radius"], json!([2.0, 2.0]));
    assert_eq!(answer["smoothness"]["holder"], json!([2.0, 2.0]));
    assert_eq!((&answer["sum_rules"], &answer["reproduction_degree"]), (&json!(4), &json!(3)));
    assert_eq!(answer["support"], json!([-3.0, 3.0]));
    assert_eq!(texts(&answer["limit_mask"]["exact"]), ["1"]);
    assert_eq!(texts(&answer["tangent_mask"]["exact"]), ["1/12", "-2/3", "0", "2/3", "-1/12"]);
    assert_eq!(numbers(&answer["local_eigenvalues"]), [1.0, 0.5, 0.25, 0.25, 0.125]);
}

#[test]
fn a_b_spline_of_degree_g_is_c_g_minus_1_and_not_c_g_by_refinement_of_any_arity() {
    for arity in [2, 3, 4, 8] {
        for degree in 1..=6_i64 {
            let answer = preset("d-ary-b-spline", &json!({ "arity": arity, "degree": degree }));
            assert_eq!(smoothness(&answer), (degree - 1, Some(degree)), "arity {arity}, degree {degree}");
            assert_eq!(answer["generation_degree"], json!(degree));
            assert_eq!(answer["reproduction_degree"], json!(1), "arity {arity}, degree {degree}");
            let support = numbers(&answer["support"]);
            assert!((support[1] - support[0] - f64::from(u8::try_from(degree).unwrap()) - 1.0).abs() < 1e-15);
        }
    }
    for degree in 1..=12_i64 {
        let answer = preset("b-spline", &json!({ "degree": degree }));
        assert_eq!(smoothness(&answer), (degree - 1, Some(degree)), "degree {degree}");
    }
    let cubic = preset("cubic-b-spline", &json!({}));
    assert_eq!(texts(&cubic["limit_mask"]["exact"]), ["1/6", "2/3", "1/6"]);
    assert_eq!(texts(&cubic["tangent_mask"]["exact"]), ["-1/2", "0", "1/2"]);
}

#[test]
fn the_schemes_of_deslauriers_and_dubuc_reproduce_what_they_interpolate() {
    for (n, k) in [(1, 0), (2, 1), (3, 2), (4, 3), (5, 4), (6, 4)] {
        let answer = preset("two-n-point", &json!({ "n": n }));
        assert_eq!(smoothness(&answer), (k, Some(k + 1)), "n = {n}");
        assert_eq!(answer["reproduction_degree"], json!(2 * n - 1));
    }
    let fourteen = numbers(&preset("two-n-point", &json!({ "n": 4 }))["smoothness"]["holder"]);
    assert!(fourteen[0] > 3.54 && fourteen[1] < 3.5512, "{fourteen:?}");
    // The norms of four factors are within 18% of the radius in these coordinates, and within 42% in others.
    let widest = preset("two-n-point", &json!({ "n": 16 }));
    let norm = widest["smoothness"]["norm"].as_str().unwrap_or_default();
    assert!(norm.starts_with("ellipsoidal"), "{norm}");
}

#[test]
fn the_ternary_five_point_scheme_is_c4_exactly_for_eta_between_0_and_1_over_81() {
    let c4 = |eta: &str| smoothness(&preset("ternary-c4", &json!({ "eta": eta })));
    for eta in ["1/1000000", "1/243", "1/162", "1/82", "1/81 - 1/1000000"] {
        let (proved, disproved) = c4(eta);
        assert!(proved == 4 && disproved == Some(5), "eta = {eta}: {proved}, {disproved:?}");
    }
    for eta in ["-1/1000000", "0", "1/81 + 1/1000000", "1/54"] {
        let (proved, disproved) = c4(eta);
        assert!(proved == 3 && disproved == Some(4), "eta = {eta}: {proved}, {disproved:?}");
    }
    // the residual 1 - z + z^2 vanishes at the other third roots of -1, so that shifts are not stable there: the basic
    // limit function is the mean of two neighbouring quartic B-splines
    assert_eq!(c4("1/81"), (3, Some(4)));
    let end = preset("ternary-c4", &json!({ "eta": "1/81" }));
    let reduction = &end["smoothness"]["reduction"];
    assert_eq!(texts(&reduction["combination"]["exact"]), ["1/2", "1/2"]);
    assert_eq!(reduction["mask"]["exact"], preset("ternary-quartic", &json!({}))["mask"]["exact"]);
    assert_eq!(end["smoothness"]["holder"], json!([4.0, 4.0]));
    let (quintic, spline) = (preset("ternary-c4", &json!({})), preset("ternary-quintic", &json!({})));
    assert_eq!(quintic, spline, "eta = 1/243 is the quintic B-spline");
    assert_eq!(quintic["sum_rules"], json!(6));
}

#[test]
fn the_ternary_interpolating_schemes_have_the_ranges_that_are_proved() {
    let three = |alpha: &str| smoothness(&preset("ternary-three-point", &json!({ "alpha": alpha })));
    for alpha in ["2/9 + 1/1000", "1/4", "1/3 - 1/1000"] {
        assert_eq!(three(alpha), (1, Some(2)), "alpha = {alpha}");
    }
    for alpha in ["2/9", "2/9 - 1/1000", "1/3 + 1/1000"] {
        let (proved, disproved) = three(alpha);
        assert!(proved < 1 && disproved == Some(1), "alpha = {alpha}: {proved}, {disproved:?}");
    }
    let four = |mu: &str| smoothness(&preset("ternary-four-point", &json!({ "mu": mu })));
    for mu in ["1/15 + 1/1000", "1/11", "0.1", "1/9 - 1/1000"] {
        assert_eq!(four(mu), (2, Some(3)), "mu = {mu}");
    }
    for mu in ["1/15", "1/9", "1/9 + 1/1000"] {
        let (proved, disproved) = four(mu);
        assert!(proved < 2 && disproved == Some(2), "mu = {mu}: {proved}, {disproved:?}");
    }
}

#[test]
fn combined_ternary_schemes_contain_the_quartic_b_spline_and_are_c3_at_most_where_they_do() {
    let novara = preset("ternary-combined-novara", &json!({ "alpha": "-2/27", "beta": "5/81", "gamma": "1/81" }));
    let pan = preset("ternary-combined-pan", &json!({ "alpha": "5/4", "beta": "1/9" }));
    for answer in [&novara, &pan] {
        assert_eq!(smoothness(answer), (3, Some(4)));
        assert_eq!(answer["mask"]["exact"], preset("ternary-quartic", &json!({}))["mask"]["exact"]);
    }
    let rehan = |alpha: &str| smoothness(&preset("ternary-combined-rehan", &json!({ "alpha": alpha, "beta": 0 })));
    assert_eq!(rehan("1/60"), (3, Some(4)), "4/243 < 1/60 < 7/405");
    assert_eq!(rehan("1/50"), (2, Some(3)));
    assert_eq!(rehan("0"), (1, Some(2)), "the ternary scheme of Deslauriers and Dubuc");
}

#[test]
fn the_static_push_back_is_c3_exactly_between_minus_2_and_0() {
    let family = |delta: &str| smoothness(&word("UCP", &json!({ "delta": delta })));
    for delta in ["-1.9", "-3/2", "-1", "-1/10", "-1/1000"] {
        assert!(family(delta).0 >= 3, "delta = {delta}: {:?}", family(delta));
    }
    assert_eq!(family("-1/2"), (4, Some(5)), "the quintic B-spline");
    assert_eq!(family("0"), (2, Some(3)), "the cubic B-spline");
    assert_eq!(family("-2"), (2, Some(3)), "the mean of three neighbouring cubic B-splines");
    assert_eq!(family("1/2"), (2, Some(3)));
    assert_eq!(family("1"), (1, Some(2)));
    let half = numbers(&word("UCP", &json!({ "delta": "1/2" }))["smoothness"]["holder"]);
    let exact = 3.0 - planish::math::functions::ln(1.5) / planish::math::functions::ln(2.0);
    assert!(half[0] <= exact && exact <= half[1] && half[1] - half[0] < 1e-12, "3 - log2(1 + delta)");
}

/// Zhang and Wang, remark after theorem 2: a simple subdominant eigenvalue is no proof of smoothness.
#[test]
fn the_push_back_with_kernel_one_tenth_is_a_counter_example_to_the_remark() {
    let answer = asked(&json!({ "plan": { "word": "UCP",
        "parameters": { "kernel": 0.1, "compensation": 1.7, "delta": 1 } } }));
    assert_eq!(smoothness(&answer), (0, Some(1)));
    let worse = word("UCP", &json!({ "kernel": 0.1, "compensation": 1.9, "delta": 1 }));
    let holder = numbers(&worse["smoothness"]["holder"]);
    assert!(holder[0] > 0.89 && holder[1] < 0.9, "{holder:?}");
}

/// Zhang and Wang, figures 1f to 1h and table 1e, in the limit alpha = 0.
#[test]
fn static_limits_of_the_figures_have_the_exponents_of_the_reference() {
    for ([kernel, compensation, delta], exponent) in [
        (["2", "1", "1"], 1.3425),
        (["1.5", "1", "0.5"], 1.6079),
        (["1.2", "1", "1"], 1.6198),
        (["10", "1", "0.8"], 1.0837),
        (["1", "1", "-0.1"], 3.1520),
        (["1", "1", "0.25"], 2.6781),
    ] {
        let answer = word("UCP", &json!({ "kernel": kernel, "compensation": compensation, "delta": delta }));
        let holder = numbers(&answer["smoothness"]["holder"]);
        let near = holder[0] <= exponent + 1e-4 && exponent - 1e-4 <= holder[1] && holder[1] - holder[0] < 5e-3;
        assert!(near, "{kernel} {compensation} {delta}: {holder:?}, {exponent}");
    }
}

#[test]
fn a_plan_that_follows_alpha_tells_its_levels_and_what_follows_from_their_limit() {
    let parameters = json!({ "alpha": "pi/6", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 1 });
    let answer = word("UCP", &parameters);
    assert_eq!(answer["kind"], "curve");
    let levels = answer["levels"].as_array().unwrap();
    assert!(
        levels.len() > 10 && levels[0]["alpha"].as_f64().unwrap() > 2.0 * levels[1]["alpha"].as_f64().unwrap() - 1e-12
    );
    assert_eq!(smoothness(&answer["static_limit"]), (1, Some(2)));
    assert_eq!(answer["exponentials"], true, "regular polygons become circles");
    assert_eq!(answer["conclusion"]["proved_c"], 1);
    assert!((answer["rate"].as_f64().unwrap() - 0.25).abs() < 1e-3, "cosines of halved angles: {}", answer["rate"]);
    let other = word("UCP", &json!({ "alpha": "pi/6", "kernel": "cos(alpha/2)", "delta": 1 }));
    assert_eq!(other["exponentials"], false, "without the compensation they do not");
    for degree in 2..=5 {
        let answer = preset("c-b-spline", &json!({ "degree": degree, "alpha": "2*pi/5" }));
        assert_eq!(answer["exponentials"], true, "degree {degree}");
        assert_eq!(smoothness(&answer["static_limit"]), (degree - 1, Some(degree)));
        // one sum rule less than the limit, and distances that shrink by 1/4
        let conclusion = &answer["conclusion"];
        assert_eq!((&conclusion["sum_rules"], &conclusion["proved_c"]), (&json!(degree - 1), &json!(degree - 1)));
    }
    for (arity, averages) in [(2, 1), (3, 1), (3, 2), (4, 2)] {
        let parameters = json!({ "arity": arity, "averages": averages, "alpha": 1 });
        assert_eq!(preset("d-ary-circle", &parameters)["exponentials"], true, "{parameters}");
    }
}

#[test]
fn schemes_without_stable_shifts_are_as_smooth_as_those_that_they_are_combined_of() {
    // all zeros of (1 + z^3)/2 are third roots of -1, of a cycle under z -> z^2; then two sub-symbols with the zero -2
    let of_cycle = json!({ "arity": 2, "first": 0, "mask": ["1/2", "1/2", 0, "1/2", "1/2"] });
    let of_divisor = json!({ "arity": 2, "first": 0, "mask": ["1/3", "2/3", "1/2", "1/3", "1/6"] });
    for (parameters, combination, found) in
        [(of_cycle, ["1/3", "1/3", "1/3"].as_slice(), (0, Some(1))), (of_divisor, &["2/3", "1/3"], (1, Some(2)))]
    {
        let answer = preset("mask", &parameters);
        assert_eq!(answer["smoothness"]["stable"], false, "{answer}");
        assert_eq!(smoothness(&answer), found, "{answer}");
        assert_eq!(texts(&answer["smoothness"]["reduction"]["combination"]["exact"]), combination, "{answer}");
        assert_eq!(answer["smoothness"]["assumptions"], json!([]));
    }
}

#[test]
fn where_stability_is_not_proved_of_rounded_masks_nothing_is_disproved() {
    let rounded = json!({ "arity": 2, "first": 0, "mask": ["1/2 + 0*pi", "1/2", 0, "1/2", "1/2"] });
    let answer = preset("mask", &rounded);
    assert_eq!(answer["smoothness"]["stable"], false, "{answer}");
    assert_eq!(answer["smoothness"]["disproved_c"], Value::Null);
    assert_eq!(answer["smoothness"]["assumptions"].as_array().unwrap().len(), 2);
}

#[test]
fn a_scheme_whose_sums_are_not_1_does_not_converge() {
    let answer = preset("mask", &json!({ "arity": 2, "first": -1, "mask": ["1/2", 1, "1/3"] }));
    assert_eq!(smoothness(&answer), (-1, Some(0)));
    assert_eq!(answer["sum_rules"], 0);
    assert_eq!(answer["smoothness"]["holder"], Value::Null);
    assert_eq!(answer.get("limit_mask"), None);
}

#[test]
fn the_basic_limit_function_of_the_cubic_b_spline_is_the_b_spline() {
    let answer = asked(&json!({ "plan": { "preset": "cubic-b-spline" }, "grid": 3 }));
    let function = &answer["basic_limit_function"];
    let (from, step) = (function["from"].as_f64().unwrap(), function["step"].as_f64().unwrap());
    let spline = |x: f64| {
        let x = x.abs();
        if x >= 2.0 {
            0.0
        } else if x >= 1.0 {
            (2.0 - x) * (2.0 - x) * (2.0 - x) / 6.0
        } else {
            2.0 / 3.0 - x * x * (1.0 - x / 2.0)
        }
    };
    let values = numbers(&function["values"]);
    assert!(values.len() >= 31);
    for (k, value) in (0_u16..).zip(&values) {
        let x = from + f64::from(k) * step;
        assert!((value - spline(x)).abs() < 1e-14, "{x}: {value}");
    }
}

#[test]
fn derivatives_of_the_basic_limit_function_are_those_of_the_b_spline() {
    let answer = asked(&json!({ "plan": { "preset": "cubic-b-spline" }, "grid": 1 }));
    let derivatives = answer["derivatives"].as_array().unwrap();
    assert_eq!(derivatives.len(), 2, "C2");
    let at = |k: usize, x: f64| {
        let (from, step) = (derivatives[k]["from"].as_f64().unwrap(), derivatives[k]["step"].as_f64().unwrap());
        let values = numbers(&derivatives[k]["values"]);
        let place = (0_u16..).zip(&values).find(|(i, _)| (from + f64::from(*i) * step - x).abs() < 1e-12);
        *place.unwrap_or_else(|| panic!("{x} is not on the grid")).1
    };
    for (k, x, wanted) in
        [(0, 0.0, 0.0), (0, -1.0, 0.5), (0, 0.5, -0.625), (1, 0.0, -2.0), (1, 1.0, 1.0), (1, -1.5, 0.5), (1, 0.5, -0.5)]
    {
        assert!((at(k, x) - wanted).abs() < 1e-14, "derivative {} at {x}: {}", k + 1, at(k, x));
    }
}

#[test]
fn the_theorems_of_the_first_paper_apply_where_their_hypotheses_hold() {
    let applies = |kernel: &str, compensation: &str, delta: &str, alpha: &str| {
        let parameters = json!({ "alpha": alpha, "kernel": kernel, "compensation": compensation, "delta": delta });
        let conclusion = asked(&json!({ "plan": { "word": "UCP", "parameters": parameters } }))["conclusion"].clone();
        let theorems = conclusion["theorems"].as_array().unwrap().clone();
        let applies: Vec<bool> = theorems.iter().map(|theorem| theorem["applies"].as_bool().unwrap()).collect();
        (applies, conclusion["proved_c"].as_i64().unwrap())
    };
    let (circle, secant) = ("cos(alpha/2)", "1/cos(alpha/2)");
    assert_eq!(applies(circle, secant, "1", "pi/6"), (vec![true, true, true], 1));
    assert_eq!(applies("10*cos(alpha/2)", "1", "4/5", "pi/4"), (vec![false, true, true], 1), "table 1, row e");
    assert_eq!(applies(circle, secant, "-5/2", "pi/6"), (vec![true, false, true], 2), "the box has no such mask");
    assert_eq!(applies(circle, secant, "-1/10", "pi/6"), (vec![true, true, true], 3), "that of other parameters");
    let answer = word("UCP", &json!({ "alpha": "pi/6", "kernel": circle, "compensation": secant, "delta": 1 }));
    let (c, gamma) = (&answer["conclusion"]["decay"]["c"], &answer["conclusion"]["decay"]["gamma"]);
    let (c, gamma) = (c.as_f64().unwrap(), gamma.as_f64().unwrap());
    for (h, level) in (0_u8..8).zip(answer["levels"].as_array().unwrap()) {
        let bound = c * planish::math::functions::pow(gamma, f64::from(h)) * (1.0 + 1e-9);
        assert!(level["distance"].as_f64().unwrap() <= bound, "level {h}: {level}, {bound}");
    }
}

/// With r sum rules at every level and distances that shrink by gamma, limits are C^k with the static limit if k < r,
/// or if gamma 2^(k - r) is below 1; with slower convergence, less of its smoothness is concluded.
#[test]
fn what_is_concluded_of_levels_takes_sum_rules_or_a_rate() {
    let concluded = |word: &str, kernel: &str, delta: &str| {
        let parameters = json!({ "alpha": 1, "kernel": kernel, "compensation": 1, "delta": delta });
        let answer = asked(&json!({ "plan": { "word": word, "parameters": parameters } }));
        let conclusion = &answer["conclusion"];
        let of_limit = answer["static_limit"]["smoothness"]["proved_c"].as_i64().unwrap();
        (of_limit, conclusion["sum_rules"].as_i64().unwrap(), conclusion["proved_c"].as_i64().unwrap())
    };
    assert_eq!(concluded("UCP", "cos(alpha)", "-1/10"), (3, 2, 3), "gamma = 1/4");
    assert_eq!(concluded("UCP", "1+alpha/4", "-1/10"), (3, 2, 2), "gamma = 1/2");
    assert_eq!(concluded("UCP", "1+sqrt(alpha)/4", "-1/10"), (3, 2, 2), "gamma = 0.71");
    assert_eq!(concluded("UD", "1+sqrt(alpha)/4", "0"), (1, 1, 1), "gamma = 0.71");
    assert_eq!(concluded("UDDDDD", "1+alpha/4", "0"), (5, 5, 5), "gamma = 1/2");
    assert_eq!(concluded("UDDDDD", "1+alpha^(1/10)/4", "0"), (5, 5, 4), "gamma = 0.93");
}

/// At the first levels, alpha is a multiple of a full turn, whose cosine is that of 0; at the next ones it is not.
#[test]
fn levels_that_equal_the_static_limit_by_chance_do_not_end_the_list() {
    let answer = word("UC", &json!({ "kernel": "2+cos(alpha)", "alpha": "4*pi" }));
    let distances: Vec<f64> =
        answer["levels"].as_array().unwrap().iter().map(|level| level["distance"].as_f64().unwrap()).collect();
    assert!(distances.len() > 10 && distances[..2].iter().all(|x| *x < 1e-12), "{distances:?}");
    assert!(distances[2..5].iter().all(|x| *x > 1e-3), "{distances:?}");
    assert_eq!((&answer["conclusion"]["sum_rules"], &answer["conclusion"]["proved_c"]), (&json!(2), &json!(1)));
}

/// At w = -1/2 the four-point scheme has unstable shifts and the radius 2, so that differences do not shrink: the
/// reduced scheme with stable shifts says nothing about it.
#[test]
fn schemes_that_diverge_are_disproved_to_be_c0_whether_shifts_are_stable_or_not() {
    for (w, stable) in [("-1/2", false), ("1/2", true), ("-1", true)] {
        let answer = preset("four-point", &json!({ "w": w }));
        assert_eq!(smoothness(&answer), (-1, Some(0)), "w = {w}");
        assert_eq!(answer["smoothness"]["stable"], stable, "w = {w}");
        assert!(answer["smoothness"].get("reduction").is_none(), "w = {w}");
        assert!(numbers(&answer["smoothness"]["holder"])[1] <= 1e-9, "w = {w}: {answer}");
    }
    // at -1 the matrices have many eigenvalues whose magnitudes differ by rounding
    for (w, disproved) in [("1/2", true), ("1", true), ("-1", false)] {
        let plan = json!({ "preset": "butterfly", "parameters": { "w": w } });
        let surface = asked(&json!({ "plan": plan, "valences": [5], "boundaries": [] }));
        let smoothness = &surface["regular"]["smoothness"];
        assert_eq!(smoothness["proved_c"], -1, "w = {w}");
        assert!(smoothness["disproved_c"] == 0 || !disproved, "w = {w}: {smoothness}");
    }
}

/// A larger budget never gives a wider interval.
#[test]
fn intervals_only_get_narrower_with_more_nodes() {
    for plan in [
        json!({ "preset": "four-point", "parameters": { "w": "3/16" } }),
        json!({ "preset": "two-n-point", "parameters": { "n": 3 } }),
        json!({ "preset": "ternary-three-point", "parameters": { "alpha": "1/4" } }),
    ] {
        let mut before = [0.0, f64::INFINITY];
        for nodes in [0, 10, 1000, 100_000, 300_000, 1_000_000] {
            let answer = asked(&json!({ "plan": plan, "nodes": nodes }));
            let found = numbers(&answer["smoothness"]["joint_spectral_radius"]);
            assert!(
                before[0] <= found[0] && found[0] <= found[1] && found[1] <= before[1],
                "{plan}: {nodes} {found:?}"
            );
            assert!(answer["smoothness"]["nodes"].as_u64().unwrap() <= nodes, "{plan}: {nodes}");
            before = [found[0], found[1]];
        }
    }
}
