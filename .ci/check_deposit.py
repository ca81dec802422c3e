"""Holds .zenodo.json against the fields of Zenodo's deposit schema (legacyrecord.json of zenodo/zenodo, version 1.0.0)."""

import json
import re
import sys

TEXTS = {
    "title", "description", "access_right", "license", "version", "notes", "upload_type", "publication_date", "doi",
}
LISTS = {"creators", "keywords", "references", "related_identifiers", "contributors", "communities", "subjects"}
RELATIONS = {
    "isCitedBy", "cites", "isSupplementTo", "isSupplementedBy", "isContinuedBy", "continues", "isPartOf", "hasPart",
    "isReferencedBy", "references", "isDocumentedBy", "documents", "isReviewedBy", "reviews", "isDerivedFrom", "isSourceOf",
}


def check(path):
    deposit = json.load(open(path, encoding="utf-8"))
    unknown = set(deposit) - TEXTS - LISTS
    assert not unknown, f"Zenodo has no fields {sorted(unknown)}"
    for name in ["title", "description", "upload_type", "creators"]:
        assert deposit.get(name), f"Zenodo requires {name}"
    for name in TEXTS & set(deposit):
        assert isinstance(deposit[name], str), f"{name} must be a text"
    assert deposit["upload_type"] == "dataset" and deposit["access_right"] == "open"
    for creator in deposit["creators"]:
        assert set(creator) <= {"name", "affiliation", "orcid", "gnd"}, creator
        assert re.fullmatch(r"(\d{4}-){3}\d{3}[\dX]", creator.get("orcid", "0000-0000-0000-0000")), creator
    for related in deposit.get("related_identifiers", []):
        assert related["relation"] in RELATIONS and related["scheme"] in {"doi", "url"}, related
        assert related["scheme"] != "doi" or related["identifier"].startswith("10."), related
    assert all(isinstance(text, str) for name in ["keywords", "references"] for text in deposit.get(name, []))


for path in sys.argv[1:]:
    check(path)
