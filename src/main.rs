//! The program `stiction`.

mod elementary;

fn main() -> std::process::ExitCode {
    stiction::cli::main()
}
