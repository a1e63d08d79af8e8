"""Moon, planets, stars and the glow of the night; see docs/night.md."""
