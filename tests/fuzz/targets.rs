//! What is fuzzed: everything that reads what strangers send. A target takes any bytes and returns, or has found a
//! fault; what it checks besides is said with `assert!`.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use planish::config::Settings;
use planish::config::keys::{KeyEntry, KeyFile, Link, KeyRole, Token};
use planish::http::serve::{bind_at, serve};
use planish::input::{READERS, ReadLimits};
use planish::job::limits::Limits;
use planish::job::run;
use planish::math::expression::Expression;
use planish::scheme::word::{MAX_LETTERS, Word};
use planish::service::account::{Account, Full};
use planish::service::batches::Batches;
use planish::service::clock::Monotonic;
use planish::service::jobs::{JobState, Jobs};
use planish::service::peer::{QuotaKind, Paid, Peers};
use planish::service::store::{Manifest, Records, StoreError};
use planish::watch::Watch;
use planish::wire::JobRequest;
use planish::wire::batch::layout;
use planish::wire::read::read;

/// A target, and what it is called.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 7] = [
    ("job", job),
    ("reader", reader),
    ("expression", expression),
    ("word", word),
    ("link", link),
    ("codec", codec),
    ("record", record),
];

/// So small that no job takes long: what is looked for is what a job says, not how much it asks for.
const LIMITS: Limits = Limits {
    max_faces: 400,
    max_vertices: 500,
    max_output_bytes: 40_000,
    max_job_bytes: 2_000_000,
    max_held_bytes: u64::MAX,
};

/// A job as a body of JSON: read, told what it comes to, and run; what was promised about its size holds.
pub fn job(data: &[u8]) {
    let Ok(request) = read::<JobRequest>(data) else { return };
    let Ok(job) = request.resolve() else { return };
    let Ok(admitted) = LIMITS.admit(job) else { return };
    for output in &admitted.job().outputs {
        let mut bytes = Vec::new();
        if run(&admitted, output, &mut bytes, &Watch::new()).is_ok() {
            assert!(bytes.len() as u64 <= LIMITS.max_output_bytes, "{} bytes", bytes.len());
        }
    }
}

/// A file for each reader; the first byte chooses one, so that what is told apart by content stays together.
pub fn reader(data: &[u8]) {
    let Some((choice, bytes)) = data.split_first() else { return };
    let reader = &READERS[usize::from(*choice) % READERS.len()];
    let limits = ReadLimits { max_vertices: 2000, max_faces: 2000 };
    if let Ok(mesh) = (reader.read)(&bytes.into(), &limits) {
        assert!(mesh.positions.len() as u64 <= limits.max_vertices, "{} vertices", mesh.positions.len());
        assert!(mesh.faces.len() as u64 <= limits.max_faces, "{} faces", mesh.faces.len());
    }
}

/// An expression, and its value at some places: finite, or refused.
pub fn expression(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Ok(expression) = Expression::parse(text, "alpha") else { return };
    for x in [0.0, 1.0, -0.5, 1e300, f64::MIN_POSITIVE] {
        if let Ok(value) = expression.value(x) {
            assert!(value.is_finite(), "{value} at {x}");
        }
    }
}

/// A word over the operators: neither prefix nor cycle is longer than they may be, and its powers can be written out.
pub fn word(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Ok(word) = Word::parse(text) else { return };
    let (prefix, cycle) = (word.prefix.len(), word.cycle.len());
    assert!(prefix <= MAX_LETTERS && (1..=MAX_LETTERS).contains(&cycle), "{prefix} and {cycle} letters in {text}");
    let plain = |word: &Word| word.letters(2).count();
    let twice = Word::parse(&format!("({text})^2"));
    if let Ok(twice) = twice {
        assert_eq!(plain(&twice), 2 * plain(&word), "of {text}");
    }
}

/// A manifest as the store reads it from disk, as it is and under a checksum that fits.
pub fn codec(data: &[u8]) {
    let mut sealed = data.to_vec();
    sealed.extend_from_slice(blake3::hash(data).as_bytes());
    for bytes in [data, &sealed] {
        if let Some(manifest) = Manifest::decode(bytes) {
            assert_eq!(Manifest::decode(&manifest.encode()), Some(manifest), "what was read is written the same");
        }
    }
}

/// What the records of jobs and batches begin with.
const RECORD: &[u8] = b"plnsh";

/// Records of jobs and batches, under checksums that fit, as an earlier process may have left them: they are taken up,
/// and what is written of them afterwards is taken up again.
pub fn record(data: &[u8]) {
    let starts = (0..data.len()).filter(|at| data[*at..].starts_with(RECORD));
    let mut starts: Vec<usize> = starts.take(8).collect();
    starts.push(data.len());
    let sealed = |ends: &[usize]| {
        let record = &data[ends[0]..ends[1]];
        (vec![ends[0].to_le_bytes()[0]], [record, blake3::hash(record).as_bytes()].concat())
    };
    let left = Arc::new(Rows(Mutex::new(starts.windows(2).map(sealed).collect())));
    let (clock, patience) = (Arc::new(Monotonic::default()), Duration::from_secs(10));
    let (peers, account) = (Arc::<Peers>::default(), Account::new(1 << 30, 0));
    let memory = |bytes| -> Result<Paid, Full> { peers.charge_self(&account.records, QuotaKind::RecordBytes, bytes) };
    let jobs = Jobs::new(Some(left.clone()), clock.clone());
    let active = jobs.recover(memory, |_| Vec::new()).expect("the rows can be read");
    for run in &active {
        jobs.end(&run.job, JobState::Cancelled, |_| true);
    }
    jobs.close(patience);
    let batches = Batches::new(Some(left.clone()), clock.clone(), |text| layout(text).ok());
    for run in &batches.recover(memory).expect("the rows can be read") {
        batches.end(&run.batch, Some(run), JobState::Cancelled);
    }
    batches.close(patience);
    // rows of one byte are those from before
    left.0.lock().expect("nobody fails").retain(|key, _| key.len() > 1);
    let again = Jobs::new(Some(left.clone()), clock.clone());
    let runs = again.recover(memory, |_| Vec::new()).expect("the rows can be read");
    assert!(runs.is_empty(), "what ended is not begun again");
    assert!(active.iter().all(|run| again.get(&run.job).is_some()), "what was written can be read");
    again.close(patience);
    let again = Batches::new(Some(left), clock, |text| layout(text).ok());
    assert!(again.recover(memory).expect("the rows can be read").is_empty(), "what ended is not begun again");
    again.close(patience);
}

/// Records in memory.
#[derive(Debug)]
struct Rows(Mutex<BTreeMap<Vec<u8>, Vec<u8>>>);

impl Records for Rows {
    fn each(&self, tell: &mut dyn FnMut(&[u8], &[u8])) -> Result<(), StoreError> {
        self.0.lock().expect("nobody fails").iter().for_each(|(key, record)| tell(key, record));
        Ok(())
    }

    fn write(&self, changes: &[(Vec<u8>, Option<Vec<u8>>)]) -> Result<(), StoreError> {
        let mut rows = self.0.lock().expect("nobody fails");
        for (key, record) in changes {
            match record {
                Some(record) => rows.insert(key.clone(), record.clone()),
                None => rows.remove(key),
            };
        }
        Ok(())
    }

    fn check(&self) -> Result<(), StoreError> {
        Ok(())
    }
}

/// An address, asked of a service on a port of its own; the first byte says what the rest is in it. Any answer is
/// right but those that say the service is at fault.
pub fn link(data: &[u8]) {
    let Some((kind, rest)) = data.split_first() else { return };
    let (token, signed) = (&service().1, kind % 7 >= 4);
    let sign = |rest: &str| Link::sign(token.id(), &token.link_secret(), LATER, rest);
    let path = match kind % 7 {
        0 => format!("/v1/render?job={}", URL_SAFE_NO_PAD.encode(rest)),
        1 => {
            let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
            packed.write_all(rest).expect("memory takes it");
            format!("/kroki/svg/{}", URL_SAFE_NO_PAD.encode(packed.finish().expect("memory takes it")))
        }
        2 => format!("/v1/{}", escaped(rest)),
        3 => format!("/v1/render?{}", escaped(rest)),
        4 => {
            let mut packed = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::fast());
            packed.write_all(rest).expect("memory takes it");
            sign(&format!("{}.svg", URL_SAFE_NO_PAD.encode(packed.finish().expect("memory takes it"))))
        }
        // signed, whatever it is; and signed, but changed
        5 => sign(&escaped(rest)),
        _ => format!("/v1/r/{}", escaped(rest).replace("TOKEN", token.id())),
    };
    let status = asked(&path, signed);
    assert!(status < 500 || status == 503, "{status} for {path}");
    assert!(kind % 7 != 6 || status >= 400, "{status} for {path}, which nobody signed");
}

/// When signed addresses end: the year 2100, in seconds since 1970.
const LATER: u64 = 4_102_444_800;

/// Bytes that may stand in an address, and others by their numbers.
fn escaped(bytes: &[u8]) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/=&?:,;%+[]{}".contains(&byte);
    let letter = |byte: &u8| if plain(*byte) { char::from(*byte).to_string() } else { format!("%{byte:02X}") };
    bytes.iter().map(letter).collect()
}

/// The status that a GET is answered with; signed addresses are asked for without a key.
fn asked(path: &str, signed: bool) -> u16 {
    let (host, token) = service();
    let mut stream = TcpStream::connect(host).expect("the service listens");
    stream.set_read_timeout(Some(Duration::from_mins(1))).expect("a time to wait can be set");
    let key = if signed { String::new() } else { format!("authorization: Bearer {}\r\n", token.expose()) };
    write!(stream, "GET {path} HTTP/1.1\r\nhost: {host}\r\n{key}connection: close\r\n\r\n")
        .expect("it takes a request");
    let mut answer = Vec::new();
    let _ = stream.take(1 << 16).read_to_end(&mut answer);
    let status = answer.get(9..12).and_then(|digits| std::str::from_utf8(digits).ok()?.parse().ok());
    status.unwrap_or_else(|| panic!("no answer to {path}"))
}

/// Where the service is, which is started when it is first asked for, and the only key that it knows.
fn service() -> &'static (SocketAddr, Token) {
    static SERVICE: OnceLock<(SocketAddr, Token)> = OnceLock::new();
    SERVICE.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("planish-fuzz-{}", std::process::id()));
        let token = Token::new(|bytes| {
            bytes.fill(1);
            Ok(())
        });
        let token = token.expect("it is given its bytes");
        let entry = KeyEntry {
            id: token.id().to_owned(),
            tenant: "fuzz".to_owned(),
            role: KeyRole::Render,
            hash: token.hash(),
            link: token.link_secret(),
            created: 0,
            expires: None,
            requests_per_minute: None,
            in_flight: None,
        };
        let keys = KeyFile::of(&folder);
        std::fs::create_dir_all(&folder).expect("there is a folder for what lasts a while");
        keys.change(|keys| {
            keys.push(entry);
            Ok(())
        })
        .expect("the file of keys can be written");
        let (sender, receiver) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            let listen = SocketAddr::from(([127, 0, 0, 1], 0));
            let Limits { max_faces, max_vertices, .. } = LIMITS;
            let known = Settings { data_dir: folder, threads: 1, ..Settings::default() };
            let settings = Settings { listen, max_faces, max_vertices, ..known };
            let runtime = tokio::runtime::Runtime::new().expect("a runtime can be made");
            runtime.block_on(async {
                let clock = Arc::new(Monotonic::default());
                let (listener, app) = bind_at(settings, clock).await.expect("a port is free");
                sender.send(listener.local_addr().expect("it has an address")).expect("somebody listens");
                let _ = serve(listener, app, std::future::pending()).await;
            });
        });
        (receiver.recv().expect("the service starts"), token)
    })
}
