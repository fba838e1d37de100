//! One process, its lines, and its end.

use core::time::Duration;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel, sync_channel};
use std::thread;
use std::time::Instant;

use hpf_sim::task::Process as Settings;

use super::protocol::{self, Hello, Kind};

/// Longest line read [bytes]: a trace of the most steps and axes, in full digits.
const LONGEST_LINE: u64 = 1 << 30;
/// Lines kept that nobody has asked for; a process that prints more waits.
const LINES_AHEAD: usize = 4;
/// Time a process has to end after its input was closed.
const PARTING: Duration = Duration::from_secs(2);

/// A process that makes one rollout at a time.
pub struct Worker {
    /// From 1.
    number: usize,
    child: Child,
    /// Lines to its stdin; dropped, the stdin closes. A thread writes them, for a process that does not read must not hold
    /// up the time-out.
    requests: Option<Sender<String>>,
    lines: Receiver<Result<String, String>>,
}

impl Worker {
    /// Starts worker `number` and greets it.
    ///
    /// # Errors
    /// Why the program does not start.
    pub fn spawn(number: usize, settings: &Settings, hello: &Hello) -> Result<Self, String> {
        let [program, arguments @ ..] = settings.command.as_slice() else { return Err("the command is empty".into()) };
        let mut command = Command::new(program);
        command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped());
        // Ctrl-C is for hpf: the running update is to be finished.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().map_err(|error| format!("cannot start `{program}`: {error}"))?;
        let (mut stdin, stdout) = (child.stdin.take().expect("piped"), child.stdout.take().expect("piped"));
        let (requests, asked) = channel::<String>();
        thread::spawn(move || {
            // Where the process is gone, its silence says so.
            while let Ok(line) = asked.recv() {
                if stdin.write_all(line.as_bytes()).and_then(|()| stdin.flush()).is_err() {
                    break;
                }
            }
        });
        let (told, lines) = sync_channel(LINES_AHEAD);
        thread::spawn(move || {
            let mut reader = BufReader::new(stdout);
            loop {
                let mut line = Vec::new();
                let line = match (&mut reader).take(LONGEST_LINE).read_until(b'\n', &mut line) {
                    Ok(0) => break,
                    Ok(count) if count as u64 == LONGEST_LINE => Err(format!("printed more than {LONGEST_LINE} bytes")),
                    Ok(_) => Ok(String::from_utf8_lossy(&line).into_owned()),
                    Err(error) => Err(format!("cannot be read: {error}")),
                };
                if told.send(line).is_err() {
                    break;
                }
            }
        });
        let worker = Self { number, child, requests: Some(requests), lines };
        worker.send(hello.line(number));
        Ok(worker)
    }

    fn send(&self, line: String) {
        // A process that is gone says so when it is waited for.
        let _ = self.requests.as_ref().map(|requests| requests.send(line));
    }

    /// Waits for the answer to the greeting.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn ready(&mut self, timeout: Duration) -> Result<Kind, String> {
        let line = self.next(timeout)?;
        protocol::ready(&line)
    }

    /// Sends a line and waits for the next one.
    ///
    /// # Errors
    /// What the process did instead.
    pub fn ask(&mut self, line: &str, timeout: Duration) -> Result<String, String> {
        self.send(line.to_owned());
        self.next(timeout)
    }

    fn next(&mut self, timeout: Duration) -> Result<String, String> {
        match self.lines.recv_timeout(timeout) {
            Ok(line) => line,
            Err(RecvTimeoutError::Timeout) => Err(format!("did not answer within {} s", timeout.as_secs_f64())),
            Err(RecvTimeoutError::Disconnected) => match self.part() {
                Some(status) => Err(format!("ended ({status})")),
                None => Err("closed its output".into()),
            },
        }
    }

    /// Takes the place of a process that failed with a new one.
    ///
    /// # Errors
    /// Why there is none.
    pub fn replace(&mut self, settings: &Settings, hello: &Hello, kind: Kind, timeout: Duration) -> Result<(), String> {
        // The old one must be gone before the new one takes hold of the same robot.
        self.end();
        *self = Self::spawn(self.number, settings, hello)?;
        match self.ready(timeout) {
            Ok(found) if found == kind => Ok(()),
            Ok(_) => Err(self.blame("answers with something else than before")),
            Err(why) => Err(self.blame(&why)),
        }
    }

    /// A sentence with the worker as its subject.
    pub fn blame(&self, what: &str) -> String {
        format!("worker {} {what}", self.number)
    }

    /// Waits a while for the process to end by itself.
    fn part(&mut self) -> Option<std::process::ExitStatus> {
        let started = Instant::now();
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => return Some(status),
                Ok(None) if started.elapsed() < PARTING => thread::sleep(Duration::from_millis(5)),
                _ => return None,
            }
        }
    }

    /// Ends the process at once.
    fn end(&mut self) {
        self.requests = None;
        // What cannot be killed or waited for is gone.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Worker {
    /// Closes its input and gives it time to end.
    fn drop(&mut self) {
        self.requests = None;
        if self.part().is_none() {
            self.end();
        }
    }
}
