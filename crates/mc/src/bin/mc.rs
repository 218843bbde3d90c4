//! The command `mc`.

fn main() -> std::process::ExitCode {
    stickslip_mc::main()
}
