//! `reality-sim viewer`, run as users run it: without a display, and in a window on its own display.

#![cfg(all(feature = "viewer", target_os = "linux"))]
#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{
    collections::HashSet,
    fs::{self, File},
    io::{BufRead, BufReader, ErrorKind},
    path::PathBuf,
    process::{Child, Command, ExitStatus, Stdio},
    thread,
    time::{Duration, Instant},
};

use image::RgbImage;
use tempfile::TempDir;
use x11rb::{
    connection::Connection,
    protocol::xproto::{
        Atom, AtomEnum, ClientMessageEvent, ConnectionExt, EventMask, InputFocus, KEY_PRESS_EVENT,
        KEY_RELEASE_EVENT, KeyButMask, KeyPressEvent, Keycode, Window,
    },
    rust_connection::RustConnection,
};

const WALK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/walk");

/// Time limit, longer than anything takes on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(300);

/// Waits for the first answer that is not `None` and returns it.
#[track_caller]
fn wait_for<T>(what: &str, mut answer: impl FnMut() -> Option<T>) -> T {
    let started = Instant::now();
    loop {
        if let Some(answer) = answer() {
            return answer;
        }
        assert!(started.elapsed() < TIMEOUT, "{what}: does not happen");
        thread::sleep(Duration::from_millis(50));
    }
}

/// Process that is killed at the end of the test.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Display without a screen.
struct Display {
    /// Name of the display, as in `DISPLAY`.
    name: String,
    _server: Process,
}

impl Display {
    /// Starts a display with a free number.
    fn start() -> Self {
        let mut command = Command::new("Xvfb");
        command.args(["-displayfd", "1", "-screen", "0", "1400x900x24", "-nolisten", "tcp"]);
        let server = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut server = match server {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                panic!("Xvfb is missing, the display without a screen: run `bash scripts/setup`")
            }
            server => Process(server.unwrap()),
        };
        let mut number = String::new();
        BufReader::new(server.0.stdout.take().unwrap()).read_line(&mut number).unwrap();
        assert!(!number.trim().is_empty(), "Xvfb does not start");
        Self { name: format!(":{}", number.trim()), _server: server }
    }
}

/// Folders that the program may write to.
struct Home(TempDir);

impl Home {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["home", "data", "config", "run", "here"] {
            fs::create_dir(folder.path().join(name)).unwrap();
        }
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Makes a command `reality-sim viewer` with these folders, and without a display.
    fn viewer(&self, open: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_reality-sim"));
        command.args(["viewer", open]).current_dir(self.path("here"));
        for (variable, name) in [
            ("HOME", "home"),
            ("XDG_DATA_HOME", "data"),
            ("XDG_CONFIG_HOME", "config"),
            ("XDG_RUNTIME_DIR", "run"),
        ] {
            command.env(variable, self.path(name));
        }
        for variable in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DBUS_SESSION_BUS_ADDRESS"] {
            command.env_remove(variable);
        }
        command
    }

    /// Returns the first complete screenshot.
    fn screenshot(&self) -> Option<RgbImage> {
        let files = fs::read_dir(self.path("here")).unwrap().map(|file| file.unwrap().path());
        files.filter(|path| path.extension().is_some_and(|kind| kind == "png")).find_map(|path| {
            let picture = image::open(path).ok()?;
            Some(picture.into_rgb8())
        })
    }

    /// Returns the settings that are remembered for the next start.
    fn settings(&self) -> Option<String> {
        fs::read_to_string(self.path("data").join("reality-sim/app.ron")).ok()
    }
}

/// Window of a viewer with its program and its display.
struct Viewer {
    process: Process,
    stderr_file: PathBuf,
    connection: RustConnection,
    root: Window,
    window: Window,
}

impl Viewer {
    /// Starts the program and waits for its window.
    fn start(home: &Home, display: &Display) -> Self {
        let stderr_file = home.path("stderr.txt");
        let mut command = home.viewer(WALK);
        command.env("DISPLAY", &display.name).stderr(File::create(&stderr_file).unwrap());
        let mut process = Process(command.spawn().unwrap());
        let (connection, screen) = RustConnection::connect(Some(&display.name)).unwrap();
        let root = connection.setup().roots[screen].root;
        let window = wait_for("a window", || {
            let ended = process.0.try_wait().unwrap();
            assert!(ended.is_none(), "{ended:?}: {}", fs::read_to_string(&stderr_file).unwrap());
            let windows = connection.query_tree(root).unwrap().reply().unwrap().children;
            windows.into_iter().find(|window| title(&connection, *window) == "Reality Sim")
        });
        Self { process, stderr_file, connection, root, window }
    }

    /// Presses Ctrl and a letter once the window listens, again and again until `happens` returns something.
    fn press_ctrl_until<T>(
        &mut self,
        letter: char,
        what: &str,
        mut happens: impl FnMut(&mut Self) -> Option<T>,
    ) -> T {
        let keycode = self.keycode(letter);
        let mut pressed = None::<Instant>;
        wait_for(what, || {
            if pressed.is_none_or(|pressed| pressed.elapsed() > Duration::from_secs(5)) {
                self.press_ctrl(keycode);
                pressed = Some(Instant::now());
            }
            happens(self)
        })
    }

    fn press_ctrl(&self, detail: Keycode) {
        // The window may not be on the screen yet, or no longer: then the next attempt counts.
        let _ = self.connection.set_input_focus(InputFocus::PARENT, self.window, x11rb::CURRENT_TIME);
        for response_type in [KEY_PRESS_EVENT, KEY_RELEASE_EVENT] {
            let event = KeyPressEvent {
                response_type,
                detail,
                sequence: 0,
                time: x11rb::CURRENT_TIME,
                root: self.root,
                event: self.window,
                child: x11rb::NONE,
                root_x: 0,
                root_y: 0,
                event_x: 0,
                event_y: 0,
                state: KeyButMask::CONTROL,
                same_screen: true,
            };
            let _ = self.connection.send_event(false, self.window, EventMask::NO_EVENT, event);
        }
        let _ = self.connection.flush();
    }

    /// Returns the key that gives a letter on this display's keyboard.
    fn keycode(&self, letter: char) -> Keycode {
        let setup = self.connection.setup();
        let (first, last) = (setup.min_keycode, setup.max_keycode);
        let mapping = self.connection.get_keyboard_mapping(first, last - first + 1).unwrap().reply().unwrap();
        let mut keys = mapping.keysyms.chunks(mapping.keysyms_per_keycode.into());
        let index = keys.position(|symbols| symbols[0] == u32::from(letter)).unwrap();
        first + u8::try_from(index).unwrap()
    }

    /// Asks the window to close, as window managers do.
    fn close(&self) {
        let atom = |name: &str| -> Atom {
            self.connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom
        };
        let data = [atom("WM_DELETE_WINDOW"), x11rb::CURRENT_TIME, 0, 0, 0];
        let message = ClientMessageEvent::new(32, self.window, atom("WM_PROTOCOLS"), data);
        self.connection.send_event(false, self.window, EventMask::NO_EVENT, message).unwrap();
        self.connection.flush().unwrap();
    }

    fn ended(&mut self) -> Option<ExitStatus> {
        self.process.0.try_wait().unwrap()
    }

    /// Returns what the program wrote to standard error.
    fn stderr(&self) -> String {
        fs::read_to_string(&self.stderr_file).unwrap()
    }
}

/// Returns a window's title; empty if the window has none, or is gone.
fn title(connection: &RustConnection, window: Window) -> String {
    let property = connection.get_property(false, window, AtomEnum::WM_NAME, AtomEnum::ANY, 0, 64);
    let reply = property.ok().and_then(|property| property.reply().ok());
    reply.map(|reply| String::from_utf8_lossy(&reply.value).into_owned()).unwrap_or_default()
}

/// Runs a viewer that must not open a window, and returns its one line on standard error.
fn refusal(command: &mut Command) -> String {
    let stderr_file = tempfile::NamedTempFile::new().unwrap();
    let mut process = Process(command.stderr(stderr_file.reopen().unwrap()).spawn().unwrap());
    let status = wait_for("the end of the program", || process.0.try_wait().unwrap());
    let message = fs::read_to_string(stderr_file.path()).unwrap();
    assert_eq!(status.code(), Some(1), "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.starts_with("error: ") && !message.contains(".rs:"), "{message}");
    message
}

#[test]
fn without_a_display_the_error_is_one_line() {
    let message = refusal(&mut Home::new().viewer(WALK));
    assert!(message.contains("no display") && message.contains("xvfb-run"), "{message}");
}

#[test]
fn a_path_that_does_not_exist_is_named() {
    let message = refusal(&mut Home::new().viewer("/no/such/walk"));
    assert!(message.contains("/no/such/walk: does not exist"), "{message}");
}

#[test]
fn a_display_that_does_not_exist_is_an_error_with_its_remedy() {
    // Displays of tests have the first free numbers, so that none ever has this one.
    let message = refusal(Home::new().viewer(WALK).env("DISPLAY", ":59000"));
    assert!(message.contains("could not be opened") && message.contains("check that DISPLAY"), "{message}");
}

#[test]
fn without_a_vulkan_driver_one_line_says_what_to_install() {
    let (home, display) = (Home::new(), Display::start());
    let mut command = home.viewer(WALK);
    command.env("DISPLAY", &display.name);
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(variable, "/nonexistent");
    }
    let message = refusal(&mut command);
    assert!(message.contains("install a Vulkan driver"), "{message}");
}

#[test]
fn the_window_opens_saves_a_screenshot_and_remembers_its_settings() {
    let (home, display) = (Home::new(), Display::start());
    let mut viewer = Viewer::start(&home, &display);
    let picture = viewer.press_ctrl_until('p', "a screenshot", |_| home.screenshot());
    let (width, height) = picture.dimensions();
    assert!(width >= 640 && height >= 420, "{width} x {height}");
    let colors: HashSet<_> = picture.pixels().collect();
    assert!(colors.len() > 16, "{} colours", colors.len());
    let status = viewer.press_ctrl_until('q', "the end of the program", Viewer::ended);
    assert_eq!((status.code(), viewer.stderr().as_str()), (Some(0), ""));
    assert!(home.settings().unwrap().contains("theme"));
}

#[test]
fn the_viewer_works_without_a_writable_home() {
    let (home, display) = (Home::new(), Display::start());
    // A file takes the folder's place; a folder without permissions would not do, since root may write to those.
    fs::remove_dir(home.path("data")).unwrap();
    fs::write(home.path("data"), "a file").unwrap();
    let mut viewer = Viewer::start(&home, &display);
    viewer.close();
    let status = wait_for("the end of the program", || viewer.ended());
    assert_eq!(status.code(), Some(0), "{}", viewer.stderr());
}
