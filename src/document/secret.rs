//! Secrets that were named by a slip: told by their kind, and not a line of them shown.

/// Returns what kind of secret `text` holds, if it holds one anywhere.
pub fn secret(text: &str) -> Option<&'static str> {
    let is_armour = |line: &str| line.contains("-----BEGIN ") && line.contains("PRIVATE KEY");
    if let Some(armour) = text.lines().find(|line| is_armour(line)) {
        let is_openssh = armour.contains("OPENSSH");
        return Some(if is_openssh { "an OpenSSH private key" } else { "a private key" });
    }
    if text.trim_start().starts_with("PuTTY-User-Key-File") {
        return Some("a PuTTY private key");
    }
    // So minisign's secret keys begin, encrypted and not.
    let is_minisign = |line: &str| {
        let line = line.trim();
        (line.starts_with("RWRTY0Iy") || line.starts_with("RWQAAEIy")) && line.len() > 100
    };
    let is_commented = text
        .trim_start()
        .lines()
        .next()
        .is_some_and(|l| l.starts_with("untrusted comment:") && l.contains("secret key"));
    (is_commented || text.lines().any(is_minisign)).then_some("a minisign secret key")
}

#[cfg(test)]
mod tests {
    use super::secret;

    #[test]
    fn secrets_are_told_from_public_keys_and_documents() {
        let armoured = "a: 1\n-----BEGIN OPENSSH PRIVATE KEY-----\nb3\n";
        assert_eq!(secret(armoured), Some("an OpenSSH private key"));
        assert_eq!(secret("-----BEGIN EC PRIVATE KEY-----\n"), Some("a private key"));
        assert_eq!(secret("PuTTY-User-Key-File-3: ssh-rsa\n"), Some("a PuTTY private key"));
        let minisign = "untrusted comment: minisign encrypted secret key\nRWRTY0Iy\n";
        assert_eq!(secret(minisign), Some("a minisign secret key"));
        let alone = format!("RWRTY0Iy{}", "A".repeat(204));
        assert_eq!(secret(&alone), Some("a minisign secret key"));
        for open in [
            "untrusted comment: minisign public key 8A90CDF65360EC10\nRWQQ7GBT\n",
            "alice@example.org ssh-ed25519 AAAA\n",
            "-----BEGIN SSH SIGNATURE-----\n",
            "reenact: 1\nlimits: [signed with a minisign encrypted secret key]\n",
        ] {
            assert_eq!(secret(open), None, "{open}");
        }
    }
}
