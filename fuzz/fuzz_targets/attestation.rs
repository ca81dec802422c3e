//! Attestations of anyone, and signatures that anyone puts into them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::verify::Envelope;

fuzz_target!(|files: (&[u8], &[u8])| {
    let (attestation, signature) = files;
    let Ok(mut envelope) = Envelope::read("a.json", attestation) else { return };
    if envelope.put("a.sig", signature).is_ok() {
        assert!(!signature.is_empty(), "signed with nothing");
    }
    let written = envelope.to_json();
    let again = Envelope::read("a.json", written.as_bytes()).expect("what was written is read");
    assert_eq!((again.to_json(), again.to_sign()), (written, envelope.to_sign()));
});
