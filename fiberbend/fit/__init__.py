"""`fiberbend fit`: laws of rubber from tests, compared, drawn and written; their band on P(θ)."""
