"""Checks for authors of profiles and substrates: `check_profile` and `check_substrate`."""

from contact.model.plugin_checks.reports import (
    Fault,
    ProfileFault,
    Report,
    SubstrateFault,
    check_profile,
    check_substrate,
)

__all__ = ["Fault", "ProfileFault", "Report", "SubstrateFault", "check_profile", "check_substrate"]
