//! The program `stiction`.

use stiction::cli::Allocator;

#[global_allocator]
static ALLOCATOR: Allocator = Allocator;

fn main() -> std::process::ExitCode {
    stiction::cli::main()
}
