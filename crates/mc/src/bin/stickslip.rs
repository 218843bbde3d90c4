//! The command `mc` under a name that no other program has.

fn main() -> std::process::ExitCode {
    stickslip_mc::main()
}
