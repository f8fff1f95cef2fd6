//! The program `stiction`.

fn main() -> std::process::ExitCode {
    stiction::cli::main()
}
