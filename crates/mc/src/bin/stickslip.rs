//! The command `mc` under a name that no other program uses.

fn main() -> std::process::ExitCode {
    stickslip_mc::main()
}
