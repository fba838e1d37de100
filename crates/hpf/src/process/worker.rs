//! One slot for a process: its start, its lines, its end.

use core::time::Duration;
use std::io::{BufRead, BufReader, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::thread;
use std::time::Instant;

use hpf_sim::task::Process as Settings;

use super::group::Group;
use super::protocol::{self, Hello};
use crate::answers::Kind;
use crate::watch::{Nobody, Watch};

/// Time in which a process should end after its input was closed, before it is signaled.
pub const PARTING: Duration = Duration::from_secs(2);
/// Time between checks whether hpf was asked to end.
const GLANCE: Duration = Duration::from_millis(50);

/// A slot for a process that makes one rollout at a time; it may be empty.
pub struct Worker {
    /// From 1.
    number: usize,
    running: Option<Running>,
}

struct Running {
    group: Group,
    since: Instant,
    /// Lines to its stdin; dropped, the stdin closes. A thread writes them, for a process that does not read must not hold
    /// up the time-out.
    requests: Sender<String>,
    /// Lines from its stdout, none read ahead of the one that waits here: a process that prints more waits, too.
    lines: Receiver<Result<String, String>>,
}

impl Worker {
    /// Place `number`, with nobody in it.
    pub fn new(number: usize) -> Self {
        Self { number, running: None }
    }

    /// Whether a process is in its place.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Starts the program and greets it.
    ///
    /// # Errors
    /// Why the program does not start.
    pub fn spawn(&mut self, settings: &Settings, hello: &Hello) -> Result<(), String> {
        let [program, arguments @ ..] = settings.command.as_slice() else { return Err("the command is empty".into()) };
        let folder = settings.folder.as_deref().map(Path::new);
        // A path leads from the folder of the program, a plain name to wherever programs are.
        let path = match folder {
            Some(folder) if Path::new(program).components().nth(1).is_some() => folder.join(program),
            _ => PathBuf::from(program),
        };
        let mut command = Command::new(path);
        command.args(arguments);
        folder.map(|folder| command.current_dir(folder));
        let place = folder.map_or_else(String::new, |folder| format!(" in {}", folder.display()));
        let started = Group::start(command, self.number);
        let (group, mut stdin, stdout) =
            started.map_err(|error| format!("cannot start `{program}`{place}: {error}"))?;
        let (requests, asked) = channel::<String>();
        thread::spawn(move || {
            // Where the process is gone, its silence says so.
            while let Ok(line) = asked.recv() {
                if stdin.write_all(line.as_bytes()).and_then(|()| stdin.flush()).is_err() {
                    break;
                }
            }
        });
        let (sender, lines) = sync_channel(0);
        let most = hello.longest_line();
        thread::spawn(move || read_lines(BufReader::new(stdout), most, &sender));
        // A process that is gone says so when it is waited for.
        let _ = requests.send(hello.line(self.number));
        self.running = Some(Running { group, since: Instant::now(), requests, lines });
        Ok(())
    }

    /// Waits for the answer to the greeting, which is due `timeout` after the start.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn ready(&mut self, hello: &Hello, timeout: Duration, watch: &dyn Watch) -> Result<Kind, String> {
        let left = self.running.as_ref().map_or(timeout, |running| timeout.saturating_sub(running.since.elapsed()));
        let line = self.next(left, timeout, &|| watch.is_asked())?;
        protocol::ready(&line, hello.most_residuals())
    }

    /// Starts the program anew, for answers of the same `kind` as before.
    ///
    /// # Errors
    /// Why it does not come up; what there is of it is still to be ended.
    pub fn start(
        &mut self,
        settings: &Settings,
        hello: &Hello,
        kind: Kind,
        timeout: Duration,
        watch: &dyn Watch,
    ) -> Result<(), String> {
        self.spawn(settings, hello)?;
        match self.ready(hello, timeout, watch)? {
            found if found == kind => Ok(()),
            _ => Err("answers with something else than before".into()),
        }
    }

    /// Sends a line and waits for the next one.
    ///
    /// # Errors
    /// What the process did instead.
    pub fn ask(&mut self, line: &str, timeout: Duration, watch: &dyn Watch) -> Result<String, String> {
        // A process that is gone says so when it is waited for.
        let _ = self.running.as_ref().map(|running| running.requests.send(line.to_owned()));
        self.next(timeout, timeout, &|| watch.is_urgent())
    }

    /// The next line, within `left` of the time `allowed`, unless `is_broken_off`.
    fn next(&mut self, left: Duration, allowed: Duration, is_broken_off: &dyn Fn() -> bool) -> Result<String, String> {
        let Some(running) = &mut self.running else { return Err("is not running".into()) };
        let begun = Instant::now();
        loop {
            let rest = left.saturating_sub(begun.elapsed());
            match running.lines.recv_timeout(rest.min(GLANCE)) {
                Ok(line) => return line,
                Err(RecvTimeoutError::Timeout) if is_broken_off() => return Err("was broken off".into()),
                Err(RecvTimeoutError::Timeout) if rest > GLANCE => {}
                Err(RecvTimeoutError::Timeout) => {
                    return Err(format!("did not answer within {} s", allowed.as_secs_f64()));
                }
                Err(RecvTimeoutError::Disconnected) => return Err(ending(running.group.status(PARTING))),
            }
        }
    }

    /// Ends the process and all that it started, after it had `patience` to end without a signal.
    ///
    /// # Errors
    /// Which processes cannot be ended: the place is not to be used again.
    pub fn end(&mut self, patience: Duration, watch: &dyn Watch) -> Result<(), String> {
        let Some(Running { mut group, requests, .. }) = self.running.take() else { return Ok(()) };
        // It sees the end of its input.
        drop(requests);
        group.end(patience, || watch.is_urgent()).map_err(|why| self.blame(&why))
    }

    /// A sentence with the worker as its subject.
    pub fn blame(&self, what: &str) -> String {
        format!("worker {} {what}", self.number)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // Nobody is left to hear what cannot be ended.
        let _ = self.end(PARTING, &Nobody);
    }
}

/// What is said of a process that prints no more.
fn ending(status: Option<ExitStatus>) -> String {
    status.map_or_else(|| "closed its output".into(), |status| format!("ended ({status})"))
}

/// Hands on the lines of a process, each of `most` bytes at most, until one is none or nobody takes them.
fn read_lines(mut reader: impl BufRead, most: usize, sender: &SyncSender<Result<String, String>>) {
    loop {
        let mut line = Vec::new();
        let line = match (&mut reader).take(most as u64 + 1).read_until(b'\n', &mut line) {
            Ok(0) => return,
            Ok(_) if line.len() > most => {
                Err(format!("printed a line of more than {most} bytes, the most of this task"))
            }
            Ok(_) if line.last() != Some(&b'\n') => Err("ended in the middle of a line".into()),
            Ok(_) => String::from_utf8(line).map_err(|_| "printed a line that is not UTF-8".into()),
            Err(error) => Err(format!("cannot be read: {error}")),
        };
        let is_over = line.is_err();
        if sender.send(line).is_err() || is_over {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is handed on of `bytes`, with lines of 8 bytes at most.
    fn lines(bytes: &'static [u8]) -> Vec<Result<String, String>> {
        let (sender, lines) = sync_channel(0);
        thread::spawn(move || read_lines(bytes, 8, &sender));
        lines.iter().collect()
    }

    #[test]
    fn lines_are_bounded_whole_and_text() {
        let [one, two] = ["1234567\n", "\n"].map(|line| Ok(line.to_owned()));
        assert_eq!(lines(b"1234567\n\n"), [one.clone(), two]);
        for (bytes, words) in [
            (&b"1234567\n12345678\n"[..], "more than 8 bytes"),
            (b"1234567\nxxxxxxxxxxxxxxxxxxxxxxxx", "more than 8 bytes"),
            (b"1234567\n12", "in the middle of a line"),
            (b"1234567\n\xff\n1\n", "not UTF-8"),
        ] {
            let found = lines(bytes);
            assert_eq!(found.len(), 2, "nothing is read after what is no line");
            assert_eq!(found[0], one);
            assert!(found[1].as_ref().unwrap_err().contains(words), "{found:?}");
        }
    }
}
