//! Gives the shared library the name under which programs look for it, if `make` asks for one.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=CONTACTBENCH_SONAME");
    if let Ok(name) = std::env::var("CONTACTBENCH_SONAME") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,{name}");
    }
}
