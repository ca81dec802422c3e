//! `reenact attest`: a signature put into an attestation. It is made elsewhere: no private key is ever read here.

use crate::cli::args::AttestArgs;
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::Terminal;
use crate::verify::Envelope;

/// Puts the signature in.
pub(in crate::cli) fn run(args: &AttestArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let name = args.attestation.display().to_string();
    let mut envelope = Envelope::read(&name, &load::attestation(&args.attestation)?)
        .map_err(Failure::not_understood)?;
    let signature = load::attestation(&args.signature)?;
    let key = envelope
        .put(&args.signature.display().to_string(), &signature)
        .map_err(|fault| Failure { exit: Exit::No, message: fault.to_string() })?;
    load::write(&args.attestation, envelope.to_json().as_bytes())?;
    terminal.result(&format!("{name}: signed with the key {key}"));
    Ok(Exit::Yes)
}
