//! Answers: what the service says besides artifacts.
