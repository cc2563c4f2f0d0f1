//! TEMPORARY laboratory.
use super::basis::Basis;
use super::compress::{self, Budget, Compressor};
use super::dense::symmetric_eigen;
use super::operator::vertices_of;
use super::rows::FINE_BAND;
use super::transfer::{GROUP, GroupTransfer, Sampling, Scratch, sample_group, vertex_rays};
use super::*;
use crate::maths::hash::uniform;
use crate::maths::sampling::sphere_direction;
use crate::scene::{PlacedLight, Scene};
use crate::surface::{Detail, NONE, direct};

const L: usize = 32;
type Field = Vec<[f32; L]>;

fn env(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

struct Truth {
    parts: Vec<u32>,
    /// per part, per slot
    fields: Vec<Field>,
}

struct Report { mean: f64, p95: f64, worst: f64, signed: f64, kinds: [f64; 4] }

fn report(basis: &Basis, surface: &Surface, truth: &[Vec<[f32; L]>], est: &[Vec<[f32; L]>], parts: &[u32]) -> Report {
    let mut errs = Vec::new();
    let mut signed = Vec::new();
    let mut kinds = [(0.0, 0.0); 4];
    for l in 0..L {
        let (mut e, mut r, mut s, mut m) = (0.0, 0.0, 0.0, 0.0);
        for (pi, &p) in parts.iter().enumerate() {
            for (i, slot) in basis.slot_range(p).enumerate().step_by(8) {
                let v = basis.vertex_of_slot()[slot] as usize;
                let a = f64::from(surface.vertices.areas()[v]);
                let t = f64::from(truth[pi][i][l]);
                let d = f64::from(est[pi][i][l]) - t;
                e += a * d * d; r += a * t * t; s += a * d; m += a * t;
            }
        }
        if r > 1e-12 {
            let x = (e / r).sqrt();
            errs.push(x); signed.push(s / m);
            let k = kind(l);
            kinds[k].0 += x; kinds[k].1 += 1.0;
        }
    }
    errs.sort_by(f64::total_cmp);
    let n = errs.len();
    Report { mean: errs.iter().sum::<f64>() / n as f64 * 100.0, p95: errs[(n * 95 / 100).min(n - 1)] * 100.0, worst: errs[n - 1] * 100.0,
        signed: signed.iter().sum::<f64>() / n as f64 * 100.0, kinds: kinds.map(|(a, b)| if b > 0.0 { a / b * 100.0 } else { 0.0 }) }
}

fn kind(l: usize) -> usize { match l { 0..12 => 0, 12..20 => 1, 20..28 => 2, _ => 3 } }

fn print(name: &str, bytes: f64, r: &Report) {
    println!("{name:42} {bytes:6.0} B  mean {:5.2} p95 {:5.2} worst {:6.2} signed {:+5.2} | point {:5.2} spot {:5.2} sun {:5.2} sky {:5.2}", r.mean, r.p95, r.worst, r.signed, r.kinds[0], r.kinds[1], r.kinds[2], r.kinds[3]);
}

fn lights(surface: &Surface, basis: &Basis, run: &RunSettings) -> Field {
    let seed = 0x7a11;
    let places = places::Places::of(surface, run.level);
    let shadows = direct::Shadows::of_surface(surface, run.level);
    let dir = |i, d| sphere_direction([uniform(seed, i, d), uniform(seed, i, d + 1)]);
    let mut field = vec![[0.0; L]; basis.slot_count()];
    for l in 0..28u32 {
        let light = match kind(l as usize) {
            0 => PlacedLight::unit_point(places.room_point([seed, l], env("LAB_DIST", 0.05))),
            1 => PlacedLight::unit_spot(places.room_point([seed, l], env("LAB_DIST", 0.05)), dir(l, 8), if l < 16 { 30.0 } else { 10.0 }),
            _ => prior::unit_sun(&places, [seed, l]),
        };
        let e = direct::at_vertices(&shadows, &light);
        let rms = (e.iter().map(|e| f64::from(e.x) * f64::from(e.x)).sum::<f64>() / e.len() as f64).sqrt();
        for (v, e) in e.iter().enumerate() {
            if rms > 0.0 { field[basis.slot_of_vertex()[v] as usize][l as usize] = (f64::from(e.x) / rms) as f32; }
        }
    }
    let axes: Vec<Vec3> = (0..4).map(|i| dir(100 + i, 8)).collect();
    let sky: Vec<[f32; 4]> = (0..surface.vertices.len()).into_par_iter().map(|v| {
        let mut out = [0.0; 4];
        for (_, (d, hit)) in vertex_rays(surface, run.level, [seed, v as u32], 256) {
            if hit.is_none() { for k in 0..4 { out[k] += if k == 0 { 1.0 } else { d.dot(axes[k]).max(0.0) } / 256.0; } }
        }
        out
    }).collect();
    for k in 0..4 {
        let rms = (sky.iter().map(|e| f64::from(e[k]) * f64::from(e[k])).sum::<f64>() / sky.len() as f64).sqrt();
        for (v, e) in sky.iter().enumerate() {
            if rms > 0.0 { field[basis.slot_of_vertex()[v] as usize][28 + k] = (f64::from(e[k]) / rms) as f32; }
        }
    }
    field
}

/// E at receivers of a part by rays of a seed.
fn truth_part(surface: &Surface, basis: &Basis, level: Level, part: u32, rays: u32, seed: u32, field: &Field) -> Field {
    basis.slot_range(part).into_par_iter().map(|slot| {
        if (slot - basis.slot_range(part).start) % 8 != 0 { return [0.0; L]; }
        let v = basis.vertex_of_slot()[slot];
        let mut sum = [0.0_f32; L];
        let mut inside = 0;
        for (_, (_, hit)) in vertex_rays(surface, level, [seed, v], rays) {
            let Some(hit) = hit else { continue };
            let corners = surface.vertices.of_triangle(hit.triangle, hit.front);
            if corners == [NONE; 3] { inside += 1; continue; }
            for (c, w) in corners.into_iter().zip(hit.barycentrics) {
                if c != NONE && w > 0.0 {
                    let f = &field[basis.slot_of_vertex()[c as usize] as usize];
                    for l in 0..L { sum[l] += w * f[l]; }
                }
            }
        }
        sum.map(|s| s / (rays - inside).max(1) as f32)
    }).collect()
}

fn apply_groups(basis: &Basis, part: u32, groups: &[GroupTransfer], field: &Field) -> Field {
    let mut out = Vec::new();
    for (g, first) in groups.iter().zip(basis.slot_range(part).step_by(GROUP)) {
        let count = (basis.slot_range(part).end - first).min(GROUP);
        let mut sums = [[0.0_f32; L]; GROUP];
        for (s, w) in &g.entries {
            let f = &field[*s as usize];
            for lane in 0..GROUP { if w[lane] != 0.0 { for l in 0..L { sums[lane][l] += w[lane] * f[l]; } } }
        }
        out.extend_from_slice(&sums[..count]);
    }
    out
}

/// Projects and reconstructs.
fn project(basis: &Basis, field: &Field) -> (Vec<[f32; L]>, Field) {
    let mut b = vec![[0.0_f32; L]; basis.function_count()];
    for slot in 0..basis.slot_count() {
        let (part, row) = basis.row(slot as u32);
        for (k, &s) in basis.function_range(part).zip(row) { for l in 0..L { b[k][l] += s * field[slot][l]; } }
    }
    let smooth = (0..basis.slot_count()).map(|slot| {
        let (part, row) = basis.row(slot as u32);
        let mut out = [0.0_f32; L];
        for (k, &s) in basis.function_range(part).zip(row) { for l in 0..L { out[l] += s * b[k][l]; } }
        out
    }).collect();
    (b, smooth)
}

/// Near split of a group: the `count` senders with largest sum of squares.
fn split(g: &GroupTransfer, count: usize) -> (Vec<(u32, [f32; GROUP])>, Vec<(u32, [f32; GROUP])>) {
    let mut order: Vec<(f32, u32)> = g.entries.iter().enumerate().map(|(i, (_, w))| (w.iter().map(|w| w * w).sum(), i as u32)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut near = vec![false; g.entries.len()];
    for &(_, i) in order.iter().take(count) { near[i as usize] = true; }
    let pick = |want: bool| g.entries.iter().zip(&near).filter(|&(_, &n)| n == want).map(|(&e, _)| e).collect::<Vec<_>>();
    (pick(true), pick(false))
}

struct PartRows {
    near: Vec<Vec<(u32, [f32; GROUP])>>,
    /// n_p x K over `functions`
    c: Vec<f32>,
    functions: Vec<u32>,
    arrived: Vec<f64>,
}

fn part_rows(basis: &Basis, part: u32, groups: &[GroupTransfer], near_count: usize) -> PartRows {
    let n = basis.slot_range(part).len();
    let mut touched = vec![false; basis.part_count()];
    let splits: Vec<_> = groups.iter().map(|g| split(g, near_count)).collect();
    for (_, r) in &splits { for (s, _) in r { touched[basis.row(*s).0 as usize] = true; } }
    let mut functions = Vec::new();
    let mut offset = vec![usize::MAX; basis.part_count()];
    for p in 0..basis.part_count() { if touched[p] { offset[p] = functions.len(); functions.extend(basis.function_range(p as u32).map(|k| k as u32)); } }
    let k = functions.len();
    let mut c = vec![0.0_f32; n * k];
    let mut arrived = Vec::new();
    for (gi, (_, r)) in splits.iter().enumerate() {
        let count = (n - gi * GROUP).min(GROUP);
        arrived.extend_from_slice(&groups[gi].arrived[..count]);
        for (s, w) in r {
            let (p, row) = basis.row(*s);
            let o = offset[p as usize];
            for lane in 0..count {
                if w[lane] != 0.0 {
                    let dst = &mut c[(gi * GROUP + lane) * k + o..][..row.len()];
                    for (d, s) in dst.iter_mut().zip(row) { *d += w[lane] * s; }
                }
            }
        }
    }
    PartRows { near: splits.into_iter().map(|s| s.0).collect(), c, functions, arrived }
}

struct Svd { n: usize, values: Vec<f64>, u: Vec<f64> /* rank rows of n */, weights: Vec<f64>, col: Vec<f64> }

/// Eigenvectors of (sqrt(A) C sigma)(...)^T, all.
fn svd(rows: &PartRows, n: usize, areas: &[f64], sigma: &[f64]) -> Svd {
    let k = rows.functions.len();
    let w: Vec<f64> = areas.iter().map(|a| a.sqrt()).collect();
    let y: Vec<f64> = (0..n).flat_map(|i| (0..k).map(move |j| (i, j))).map(|(i, j)| w[i] * f64::from(rows.c[i * k + j]) * sigma[j]).collect();
    let mut g = vec![0.0; n * n];
    g.par_chunks_mut(n).enumerate().for_each(|(i, row)| {
        for j in 0..n { row[j] = dense::dot(&y[i * k..(i + 1) * k], &y[j * k..(j + 1) * k]); }
    });
    let e = symmetric_eigen(g, n).unwrap();
    let mut values: Vec<f64> = e.values.clone();
    values.reverse();
    let u = (0..n).rev().flat_map(|r| e.vectors[r * n..(r + 1) * n].to_vec()).collect();
    Svd { n, values: values.into_iter().map(|v| v.max(0.0)).collect(), u, weights: w, col: sigma.to_vec() }
}

#[test]
#[ignore]
fn lab() {
    let path = std::env::var("LAB_SCENE").unwrap();
    let scene = Scene::load(path.as_ref(), &[]).unwrap();
    let run = RunSettings::silent();
    let mut surface = Surface::fronts(&scene, &Detail::of_keys(&scene.bake));
    let backs = surface.visible_backs(run.level);
    surface.add_backs(&backs);
    let open_points = surface.open_points(run.level);
    surface.vertices.set_open_points(open_points);
    let mut settings = BakeSettings::of_keys(&scene.bake);
    let per_part = env("LAB_PART", 600.0) as u32;
    settings.vertices_per_part = per_part;
    settings.rays = env("LAB_RAYS", 1024.0) as u32;
    let per1000 = env("LAB_FUN", 32.0);
    settings.functions = Some((surface.vertices.len() as f64 * per1000 / 1000.0) as u32);
    let basis = spectral_basis(&surface, &settings, &run).unwrap();
    println!("{path}: {} vertices, {} parts, {} functions, {} rays", surface.vertices.len(), basis.part_count(), basis.function_count(), settings.rays);
    let field = lights(&surface, &basis, &run);
    let importance = Importance::of(&surface, &run, &basis).unwrap();
    let pilots = env("LAB_PILOTS", 24.0) as u32;
    let parts: Vec<u32> = (0..pilots).map(|i| ((u64::from(i) * 2 + 1) * basis.part_count() as u64 / (2 * u64::from(pilots))) as u32).collect();
    let true_rays = env("LAB_TRUE", 32768.0) as u32;
    let truth: Vec<Field> = parts.iter().map(|&p| truth_part(&surface, &basis, run.level, p, true_rays, 0x7777, &field)).collect();
    let half: Vec<Field> = parts.iter().map(|&p| truth_part(&surface, &basis, run.level, p, true_rays, 0x8888, &field)).collect();
    print("truth against another seed", 0.0, &report(&basis, &surface, &truth, &half, &parts));
    let truth: Vec<Field> = truth.iter().zip(&half).map(|(a, b)| a.iter().zip(b).map(|(a, b)| std::array::from_fn(|l| 0.5 * (a[l] + b[l]))).collect()).collect();
    let sampling = Sampling { surface: &surface, level: run.level, slot_of_vertex: basis.slot_of_vertex(), rays: settings.rays };
    let groups: Vec<Vec<GroupTransfer>> = parts.iter().map(|&p| {
        let r = basis.slot_range(p);
        let list: Vec<(u32, u32)> = r.clone().step_by(GROUP).map(|f| (f as u32, (r.end - f).min(GROUP) as u32)).collect();
        list.par_iter().map_init(|| Scratch::new(basis.slot_count()), |s, &g| sample_group(&sampling, vertices_of(&basis, g), s)).collect()
    }).collect();
    let est: Vec<Field> = parts.iter().zip(&groups).map(|(&p, g)| apply_groups(&basis, p, g, &field)).collect();
    if env("LAB_EACH", 0.0) > 0.0 { for l in 0..L { let (mut e, mut m, mut at, mut mx) = (0.0, 0.0, 0.0, 0.0_f64); let mut b0=0.0; let mut bmax=0.0_f64;
        for (pi, &p) in parts.iter().enumerate() { for (i, slot) in basis.slot_range(p).enumerate().step_by(8) { let a = f64::from(surface.vertices.areas()[basis.vertex_of_slot()[slot] as usize]); let t = f64::from(truth[pi][i][l]); let d = f64::from(est[pi][i][l]) - t; e += a*d*d; m += a*t*t; at += a; mx = mx.max(t); } }
        for slot in 0..basis.slot_count() { let a = f64::from(surface.vertices.areas()[basis.vertex_of_slot()[slot] as usize]); b0 += a * f64::from(field[slot][l]).powi(2); bmax = bmax.max(field[slot][l].into()); }
        let tot: f64 = surface.vertices.areas().iter().map(|&a| f64::from(a)).sum();
        println!("light {l}: err {:.2}% rms E1 {:.4} max {:.3} of B rms {:.3} max {:.1}", 100.0*(e/m).sqrt(), (m/at).sqrt(), mx, (b0/tot).sqrt(), bmax); } }
    print("T_N whole (sampling noise)", 0.0, &report(&basis, &surface, &truth, &est, &parts));
    let (b, smooth) = project(&basis, &field);
    let constant = basis.constant(run.level);
    for near in [0usize, 24, 48] {
        let est: Vec<Field> = parts.iter().zip(&groups).map(|(&p, g)| {
            let (ns, rs): (Vec<GroupTransfer>, Vec<GroupTransfer>) = g.iter().map(|g| { let (n, r) = split(g, near); (GroupTransfer { entries: n, ..Default::default() }, GroupTransfer { entries: r, ..Default::default() }) }).unzip();
            let a = apply_groups(&basis, p, &ns, &field);
            let c = apply_groups(&basis, p, &rs, &smooth);
            a.iter().zip(&c).map(|(a, b)| std::array::from_fn(|l| a[l] + b[l])).collect()
        }).collect();
        print(&format!("all functions, near {near}"), 0.0, &report(&basis, &surface, &truth, &est, &parts));
    }
    // Current scheme.
    {
        let compressor = Compressor { basis: &basis, sigma: &importance.sigma, witnesses: Some(&importance.witnesses), constant: &constant, budget: Budget::of(settings.coefficients) };
        let scores: Vec<f32> = groups.iter().flatten().flat_map(|g| { let mut s = compress::Scratch::new(&basis); compressor.scores(g, &mut s) }).collect();
        let count: usize = groups.iter().map(Vec::len).sum();
        let mut sorted = scores; sorted.sort_by(|a, b| b.total_cmp(a));
        let threshold = sorted.get(compressor.budget.basis * count).copied().unwrap_or(0.0);
        let mut bytes = 0.0; let mut n = 0.0;
        let est: Vec<Field> = parts.iter().zip(&groups).map(|(&p, g)| {
            let mut out = Vec::new();
            for (gi, g) in g.iter().enumerate() {
                let count = (basis.slot_range(p).len() - gi * GROUP).min(GROUP);
                let mut s = compress::Scratch::new(&basis);
                let rows = compressor.compress(g, threshold, &mut s);
                bytes += (rows.near.len() + rows.functions.len()) as f64 * 10.0 + 64.0 + 12.0; n += count as f64;
                for lane in 0..count {
                    let mut e = [0.0_f32; L];
                    for (s, w) in rows.near.iter().zip(&rows.near_weights) { for l in 0..L { e[l] += f32::from(w[lane]) * rows.near_steps[lane] * field[*s as usize][l]; } }
                    for (i, (k, c)) in rows.functions.iter().zip(&rows.coefficients).enumerate() {
                        let f = if (i as u32) < rows.coarse { 1.0 } else { 1.0 / FINE_BAND };
                        for l in 0..L { e[l] += f32::from(c[lane]) * f * rows.basis_steps[lane] * b[*k as usize][l]; }
                    }
                    out.push(e);
                }
            }
            out
        }).collect();
        print("sparse shared lists, 128", bytes / n, &report(&basis, &surface, &truth, &est, &parts));
    }
    if env("LAB_LR", 1.0) == 0.0 { return; }
    // Low rank.
    let nears: Vec<usize> = std::env::var("LAB_NEAR").unwrap_or("24".into()).split(',').map(|v| v.parse().unwrap()).collect();
    for near in nears {
        let rows: Vec<PartRows> = parts.iter().zip(&groups).map(|(&p, g)| part_rows(&basis, p, g, near)).collect();
        for mode in ["sigma", "witness"] {
            let svds: Vec<Svd> = parts.iter().zip(&rows).zip(&groups).map(|((&p, r), g)| {
                let areas: Vec<f64> = basis.slot_range(p).map(|s| f64::from(surface.vertices.areas()[basis.vertex_of_slot()[s] as usize])).collect();
                let mut weight = vec![1.0_f64; basis.part_count()];
                if mode == "witness" {
                    let mut sum = vec![0.0_f64; basis.part_count()];
                    for g in g { for (p, w) in importance.witnesses.weights(&basis, g) { sum[p as usize] += f64::from(w) / g_len(g) ; } }
                    let count = g.len() as f64;
                    weight = sum.iter().map(|s| (s / count).max(1e-6)).collect();
                }
                let sigma: Vec<f64> = r.functions.iter().map(|&k| {
                    let part = part_of_function(&basis, k);
                    if mode == "flat" { 1.0 } else { f64::from(importance.sigma[k as usize]) * weight[part as usize].sqrt() }
                }).collect();
                svd(r, areas.len(), &areas, &sigma)
            }).collect();
            for rank in [16usize, 32, 48] {
                for constant_response in [true] {
                    let est: Vec<Field> = parts.iter().zip(&rows).zip(&svds).map(|((&_p, r), s)| {
                        let n = s.n; let k = r.functions.len();
                        // V b for all lights: V = U^T sqrt(A) C ; y_r(l) = sum_j V_rj b_j
                        let mut cb = vec![[0.0_f64; L]; n];
                        for i in 0..n { for j in 0..k { let c = f64::from(r.c[i * k + j]); let bb = &b[r.functions[j] as usize]; for l in 0..L { cb[i][l] += c * f64::from(bb[l]); } } }
                        let d: Vec<f64> = (0..n).map(|i| (0..k).map(|j| f64::from(r.c[i * k + j]) * f64::from(constant[r.functions[j] as usize])).sum()).collect();
                        let rank = rank.min(n);
                        let mut out = vec![[0.0_f32; L]; n];
                        let mut y = vec![[0.0_f64; L]; rank]; let mut yd = vec![0.0; rank];
                        for q in 0..rank { for i in 0..n { let f = s.u[q * n + i] * s.weights[i]; yd[q] += f * d[i]; for l in 0..L { y[q][l] += f * cb[i][l]; } } }
                        for i in 0..n {
                            let mut e = [0.0_f64; L]; let mut ed = 0.0;
                            for q in 0..rank { let f = s.u[q * n + i] / s.weights[i].max(1e-30); ed += f * yd[q]; for l in 0..L { e[l] += f * y[q][l]; } }
                            let near_sum: f64 = r.near[i / GROUP].iter().map(|(_, w)| f64::from(w[i % GROUP])).sum();
                            let target = r.arrived[i] - near_sum;
                            let scale = if constant_response && ed > 0.0 && (0.5..=2.0).contains(&(target / ed)) { target / ed } else { 1.0 };
                            let mut o = [0.0_f32; L];
                            for l in 0..L { o[l] = (e[l] * scale) as f32; }
                            for (sl, w) in &r.near[i / GROUP] { for l in 0..L { o[l] += w[i % GROUP] * field[*sl as usize][l]; } }
                            out[i] = o;
                        }
                        out
                    }).collect();
                    print(&format!("near {near} {mode} rank {rank} const {constant_response}"), near as f64 * 1.25 + rank as f64, &report(&basis, &surface, &truth, &est, &parts));
                }
            }
        }
    }
}

fn g_len(_g: &GroupTransfer) -> f64 { 1.0 }
fn part_of_function(basis: &Basis, k: u32) -> u32 {
    (0..basis.part_count() as u32).find(|&p| basis.function_range(p).contains(&(k as usize))).unwrap()
}
