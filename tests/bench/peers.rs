//! Refinement beside OpenSubdiv: a program of our own against its library is built, and both refine the same meshes in
//! turns, from the coarse arrays to positions and faces in memory. Needs a C++ compiler and the Debian package
//! `libosd-dev`.
//!
//! OpenSubdiv runs on one thread, as its uniform refinement does; planish on as many as the machine has.

use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use planish::kept::keep_at_most;
use planish::refine::{RefinedMesh, refine_mesh};
use planish::scheme::plan::{Plan, Scheduled};
use planish::shape::mesh::Mesh;
use planish::shape::source::{FaceChunk, MeshSource};
use planish::watch::Watch;
use rayon::ThreadPoolBuilder;

use crate::nets;
use crate::table::{Table, figure, say};

/// Pairs of runs that count, at least; more while they fit into [`LONG_ENOUGH`].
const PAIRS: usize = 7;
const LONG_ENOUGH: Duration = Duration::from_secs(8);
/// Pairs of runs before those that count: the heaps become warm, the processors awake.
const WARMING: usize = 2;

/// What is compared: a name, the scheme in the peer, its mesh, the plan, the levels, and the least ratio aimed at.
struct Contest<'a> {
    name: &'a str,
    peer: &'a str,
    mesh: &'a Mesh,
    plan: &'a str,
    levels: &'a [(u32, f64)],
}

pub(crate) fn measure(_: &mut Table) {
    let program = match build() {
        Ok(program) => program,
        Err(why) => return say(&format!("peers: nothing is compared, as {why}")),
    };
    let (quads, mixed, triangles) = (nets::sphere(32), nets::mixed(32), nets::tetrakis(4));
    let contests = [
        Contest {
            name: "catmull-clark",
            peer: "catmull-clark",
            mesh: &quads,
            plan: "catmull-clark",
            levels: &[(3, 6.0), (4, 0.0), (5, 18.0), (6, 25.0)],
        },
        Contest {
            name: "mixed with creases",
            peer: "catmull-clark",
            mesh: &mixed,
            plan: "catmull-clark",
            levels: &[(3, 0.0), (5, 10.0)],
        },
        Contest { name: "loop", peer: "loop", mesh: &triangles, plan: "loop", levels: &[(3, 0.0), (5, 10.0)] },
        Contest { name: "word UC", peer: "catmull-clark", mesh: &quads, plan: "UC", levels: &[(5, 14.0)] },
        Contest { name: "word UCCP", peer: "catmull-clark", mesh: &quads, plan: "UCCP", levels: &[(5, 8.0)] },
    ];
    for contest in &contests {
        for &(level, aim) in contest.levels {
            compare(&program, contest, level, aim);
        }
    }
}

fn compare(program: &str, contest: &Contest<'_>, level: u32, aim: f64) {
    let (plan, steps) = nets::plan_of(contest.mesh, contest.plan, level);
    let mut ours = Ours {
        mesh: contest.mesh,
        plan: &plan,
        steps: &steps,
        refined: None,
        gathered: Vec::new(),
        faces: FaceChunk::default(),
    };
    let mut peer = Peer::start(program, contest, level);
    let (mut ratios, mut times) = (Vec::new(), Vec::new());
    let start = Instant::now();
    for run in 0.. {
        let (time, theirs) = (ours.run(), peer.run());
        if run == 0 {
            assert_eq!(theirs.n_faces, ours.faces.len(), "{}: both make as many faces", contest.name);
            let same = (theirs.sum - ours.sum()).abs() <= 1e-3 * real(ours.positions().len()).sqrt();
            assert!(same || contest.plan.starts_with('U'), "{}: both make the same points", contest.name);
        }
        if run >= WARMING {
            ratios.push(theirs.seconds / time);
            times.push(time);
        }
        if ratios.len() >= PAIRS && start.elapsed() > LONG_ENOUGH {
            break;
        }
    }
    ratios.sort_by(f64::total_cmp);
    times.sort_by(f64::total_cmp);
    let n = real(ours.faces.len());
    let (middle, rate) = (ratios[ratios.len() / 2], n / times[times.len() / 2] / 1e6);
    let verdict = match aim {
        0.0 => String::new(),
        aim if middle >= aim => format!(", aim {aim} met"),
        aim => format!(", aim {aim} MISSED"),
    };
    say(&format!(
        "peers {} level {level}: {} of OpenSubdiv (min {}, max {}), {} M faces/s, {} B peak a face{verdict}",
        contest.name,
        figure(middle),
        figure(ratios[0]),
        figure(ratios[ratios.len() - 1]),
        figure(rate),
        figure(ours.peak() / n),
    ));
}

/// Refinement by planish, into memory that is kept from run to run.
struct Ours<'a> {
    mesh: &'a Mesh,
    plan: &'a Plan,
    steps: &'a [Scheduled],
    refined: Option<RefinedMesh>,
    /// Positions that had to be put in order.
    gathered: Vec<[f64; 3]>,
    faces: FaceChunk,
}

impl Ours<'_> {
    /// Seconds of one run.
    fn run(&mut self) -> f64 {
        self.refined = None;
        wake();
        let start = Instant::now();
        let refined = refine_mesh(self.mesh, self.plan, self.steps, &Watch::new()).expect("nobody stops it");
        refined.faces(0..refined.n_faces(), &mut self.faces);
        if refined.held_positions().is_none() {
            refined.positions(0..refined.n_vertices(), &mut self.gathered);
        }
        self.refined = Some(refined);
        black_box((&self.refined, &self.faces));
        start.elapsed().as_secs_f64()
    }

    fn positions(&self) -> &[[f64; 3]] {
        self.refined.as_ref().and_then(MeshSource::held_positions).unwrap_or(&self.gathered)
    }

    /// The sum of the coordinates, each axis weighted differently: it does not depend on the order of vertices.
    fn sum(&self) -> f64 {
        self.positions().iter().map(|p| p[0] + 2.0 * p[1] + 3.0 * p[2]).sum()
    }

    /// Bytes that are held at most during a run which keeps its result, on one thread, whose allocations are counted.
    fn peak(&mut self) -> f64 {
        let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
        (self.refined, self.gathered, self.faces) = (None, Vec::new(), FaceChunk::default());
        keep_at_most(0);
        let counted = pool.install(|| {
            allocation_counter::measure(|| {
                self.run();
            })
        });
        keep_at_most(crate::KEPT_BYTES);
        real(usize::try_from(counted.bytes_max).expect("it fits into memory"))
    }
}

/// How long all threads are kept at work before a run. While the peer runs they sleep, and virtual processors that have
/// slept do less for a while, as if they shared a core: level 5 takes 22 ms after 10 ms of work, 21 ms after 50, and 19
/// ms from 200 on, as in a loop of its own. The peer's only thread is awake, too, when its clock starts.
const AWAKE: Duration = Duration::from_millis(300);

/// Keeps all threads at work until all processors have woken.
fn wake() {
    rayon::broadcast(|_| {
        let start = Instant::now();
        while start.elapsed() < AWAKE {
            std::hint::spin_loop();
        }
    });
}

/// The peer's program, which waits for the next run.
struct Peer {
    process: Child,
    ask: ChildStdin,
    answers: BufReader<ChildStdout>,
}

/// What a run of the peer gave.
struct Run {
    seconds: f64,
    n_faces: usize,
    sum: f64,
}

impl Peer {
    fn start(program: &str, contest: &Contest<'_>, level: u32) -> Self {
        let command = Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut process = command.expect("the program that was built starts");
        let mut ask = process.stdin.take().expect("its input is a pipe");
        let answers = BufReader::new(process.stdout.take().expect("its output is a pipe"));
        ask.write_all(described(contest, level).as_bytes()).expect("it reads its mesh");
        Self { process, ask, answers }
    }

    fn run(&mut self) -> Run {
        self.ask.write_all(b"r\n").and_then(|()| self.ask.flush()).expect("it reads what is asked");
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("it answers");
        let words: Vec<&str> = line.split_whitespace().collect();
        let [seconds, _, n_faces, sum] = words[..] else { panic!("the peer ended: {line}") };
        let number = |word: &str| word.parse().expect("a number");
        Run { seconds: number(seconds), n_faces: n_faces.parse().expect("a count"), sum: number(sum) }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // a bench that ends anyway has no use for the reason
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The mesh as the peer reads it.
fn described(contest: &Contest<'_>, level: u32) -> String {
    let (mesh, topology) = (contest.mesh, &contest.mesh.topology);
    let sizes = [topology.n_vertices(), topology.n_faces(), mesh.creases.len()];
    let head = format!("{} {level} {} {} {}", contest.peer, sizes[0], sizes[1], sizes[2]);
    let point = |p: &[f64]| format!("{:?} {:?} {:?}", p[0], p[1], p[2]);
    let face = |f: usize| {
        let face = topology.face(f);
        let vertices: Vec<String> = face.iter().map(u32::to_string).collect();
        format!("{} {}", face.len(), vertices.join(" "))
    };
    let crease = |&(edge, sharpness): &(u32, f64)| {
        let [a, b] = topology.ends(edge as usize);
        format!("{a} {b} {sharpness:?}")
    };
    let points = mesh.positions.chunks_exact(3).map(point);
    let lines =
        std::iter::once(head).chain(points).chain((0..sizes[1]).map(face)).chain(mesh.creases.iter().map(crease));
    lines.map(|line| line + "\n").collect()
}

/// A count as a number to reckon with.
#[expect(clippy::cast_precision_loss, reason = "counts are far below 2^52")]
fn real(n: usize) -> f64 {
    n as f64
}

/// Builds the peer's program; its path, or why there is none.
fn build() -> Result<String, String> {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bench/peers/osd.cpp");
    let program = concat!(env!("CARGO_TARGET_TMPDIR"), "/osd").to_owned();
    let options = ["-std=c++14", "-O3", "-march=native", "-DNDEBUG", source, "-losdCPU", "-o", &program];
    let built =
        Command::new("c++").args(options).output().map_err(|error| format!("there is no C++ compiler ({error})"))?;
    if built.status.success() {
        Ok(program)
    } else {
        let errors = String::from_utf8_lossy(&built.stderr);
        Err(format!("it cannot be built; install libosd-dev: {}", errors.lines().next().unwrap_or_default()))
    }
}
