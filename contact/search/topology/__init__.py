"""From proposed intervals to intervals whose signs are right, for zones and gaps alike."""
