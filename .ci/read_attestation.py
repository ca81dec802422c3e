"""Reads an attestation with the libraries that others wrote, and checks its signature as OpenSSH does; fails where any of them
refuses it.

    read_attestation.py REVIEW.json BUNDLE.zip ALLOWED_SIGNERS PRINCIPAL

Needs PyPI's securesystemslib (DSSE) and in-toto-attestation (Statement), and ssh-keygen.
"""

import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile
import zipfile

from google.protobuf import json_format
from in_toto_attestation.v1 import statement_pb2
from in_toto_attestation.v1.statement import Statement
from securesystemslib.dsse import Envelope

review, bundle, signers, principal = sys.argv[1:]
envelope = Envelope.from_dict(json.loads(pathlib.Path(review).read_text()))
assert envelope.payload_type == "application/vnd.in-toto+json", envelope.payload_type

# The statement, as in-toto's own library reads and validates it.
statement = Statement.copy_from_pb(json_format.Parse(envelope.payload, statement_pb2.Statement()))
statement.validate()
assert statement.pb.predicate_type == "https://crates.io/crates/reenact#re-execution/v1"
predicate = json_format.MessageToDict(statement.pb.predicate)

# Its subject is this bundle's list of digests.
with zipfile.ZipFile(bundle) as archive:
    (name,) = [name for name in archive.namelist() if name.endswith("/tagmanifest-sha256.txt")]
    digest = hashlib.sha256(archive.read(name)).hexdigest()
(subject,) = statement.pb.subject
assert subject.name == "tagmanifest-sha256.txt" and dict(subject.digest) == {"sha256": digest}, subject
assert predicate["bundleId"] == f"sha256:{digest}" and predicate["verdict"] == "holds", predicate
assert predicate["sample"]["equal"] == predicate["sample"]["executed"] > 0, predicate


def verifies(message: bytes, signature: bytes) -> bool:
    with tempfile.NamedTemporaryFile() as file:
        file.write(signature)
        file.flush()
        words = ["ssh-keygen", "-Y", "verify", "-f", signers, "-I", principal, "-n", "reenact", "-s", file.name]
        return subprocess.run(words, input=message, capture_output=True, check=False).returncode == 0


# The signature is one of OpenSSH over what DSSE says is signed, and of nothing else.
assert envelope.signatures, "unsigned"
for keyid, signature in envelope.signatures.items():
    armoured = bytes.fromhex(signature.signature)
    assert verifies(envelope.pae(), armoured), f"the signature by {keyid} does not verify"
    raised = Envelope(envelope.payload.replace(b'"holds"', b'"held!"'), envelope.payload_type, {})
    assert not verifies(raised.pae(), armoured), "a changed payload verifies"
level = f"level {predicate['level']:.0f} ({predicate['levelName']})"
print(f"{level} on {predicate['date']}, {predicate['sample']['inWords']}, signed by {', '.join(envelope.signatures)}")
