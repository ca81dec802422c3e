"""Seed roc-validator's HTTP cache, so that it judges a crate without any network.

usage: seed_roc_cache.py CACHE WHEEL

The validator resolves the JSON-LD context https://w3id.org/ro/crate/1.1/context. The wheel rocrate 0.13.0
(Apache-2.0) ships that very document; this puts it into the cache that `rocrate-validator validate --offline
--cache-path CACHE` reads (CACHE gets the suffix .sqlite).
"""

import io
import sys
import zipfile

import requests
from requests.adapters import BaseAdapter
from requests_cache import CachedSession
from urllib3 import HTTPResponse

CONTEXT = "https://w3id.org/ro/crate/1.1/context"
IN_WHEEL = "rocrate/data/ro-crate.jsonld"


class Shelf(BaseAdapter):
    """Answers every request with one document."""

    def __init__(self, document):
        super().__init__()
        self.document = document

    def send(self, request, **_):
        response = requests.Response()
        response.status_code, response.reason = 200, "OK"
        response.url, response.request = request.url, request
        response.headers["Content-Type"] = "application/ld+json"
        response.raw = HTTPResponse(
            body=io.BytesIO(self.document),
            status=200,
            headers=dict(response.headers),
            preload_content=False,
            request_url=request.url,
        )
        return response

    def close(self):
        pass


def main():
    cache, wheel = sys.argv[1:]
    document = zipfile.ZipFile(wheel).read(IN_WHEEL)
    session = CachedSession(
        cache_name=cache, backend="sqlite", expire_after=-1, allowable_methods=("GET",)
    )
    session.mount("https://", Shelf(document))
    # The cache's key covers this header; it is the one that rdflib sends.
    accept = {"Accept": "application/ld+json, application/json"}
    terms = session.get(CONTEXT, headers=accept).json()["@context"]
    print(f"seeded {CONTEXT}: {len(terms)} terms")


main()
