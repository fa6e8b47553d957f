use super::*;

fn xeon(l3: &str) -> Hardware {
    Hardware {
        cpu: Some("Intel(R) Xeon(R) Processor".into()),
        cpu_family: Some(6),
        cpu_model: Some(143),
        cpu_stepping: Some(8),
        cores: Some(2),
        caches: [("L2", "2048K"), ("L3", l3)]
            .map(|(name, size)| (name.to_string(), size.to_string()))
            .into(),
        memory_bytes: Some(25_276_502_016),
        ..Hardware::default()
    }
}

#[test]
fn sizes_are_read() {
    assert_eq!(
        ["48K", "2M\n", "512", "", "µ", "K"].map(size_of),
        [Some(48 << 10), Some(2 << 20), Some(512), None, None, None]
    );
}

#[test]
fn processors_of_one_name_are_told_apart() {
    let one = xeon("491520K");
    assert!(one.may_be(&one.clone()));
    assert!(one.may_be(&Hardware { memory_bytes: Some(25_200_000_000), ..one.clone() }));
    // What a record of an older version says, with and without the caches.
    let older = Hardware { cpu_family: None, cpu_model: None, cpu_stepping: None, ..one.clone() };
    let oldest = Hardware { caches: BTreeMap::new(), memory_bytes: None, ..older.clone() };
    assert!(one.may_be(&older) && older.may_be(&one) && oldest.may_be(&oldest));
    for other in [
        xeon("307200K"),
        Hardware { cpu_family: Some(25), ..one.clone() },
        Hardware { cpu_model: Some(106), ..one.clone() },
        Hardware { cpu_stepping: Some(4), ..one.clone() },
        Hardware { memory_bytes: Some(1 << 34), ..one.clone() },
        Hardware { cores: Some(4), ..one.clone() },
        oldest,
    ] {
        assert!(!one.may_be(&other) && !other.may_be(&one), "{other:?}");
    }
    let flags = |flags: &str| Hardware { cpu_flags: Some(flags.into()), ..one.clone() };
    assert!(!flags("1").may_be(&flags("2")) && flags("1").may_be(&one));
}

#[test]
fn the_hardware_here_is_the_same_twice_and_survives_the_provenance() {
    let here = Hardware::here();
    assert_eq!(here, Hardware::here());
    let mut fields = serde_json::to_value(&here).unwrap();
    fields["command"] = "contactbench run".into();
    assert_eq!(serde_json::from_value::<Hardware>(fields).unwrap(), here);
    #[cfg(all(target_os = "linux", target_arch = "x86_64"))]
    {
        let kernel = linux(&std::fs::read_to_string("/proc/cpuinfo").unwrap());
        let number = |it: &Hardware| (it.cpu_family, it.cpu_model, it.cpu_stepping);
        assert_eq!(number(&here), number(&kernel), "the processor and the kernel agree");
        assert_eq!((&here.cpu, &here.cpu_vendor), (&kernel.cpu, &kernel.cpu_vendor));
        let processor = processor().caches;
        for (name, size) in &here.caches {
            let said = processor.get(name).is_none_or(|said| size_of(said) == size_of(size));
            assert!(said, "{name}: {size}, {processor:?}");
        }
    }
}

#[test]
fn processors_are_read_from_what_they_say() {
    assert_eq!(signature_of(0x00a1_0f11), (25, 17, 1));
    assert_eq!(signature_of(0x000c_06f2), (6, 207, 2));
    let words = |text: &[u8; 12]| {
        let (words, _) = text.as_chunks::<4>();
        words.iter().map(|word| u32::from_le_bytes(*word)).collect::<Vec<_>>()
    };
    assert_eq!(text(&words(b" EP   YC 9\0x")).as_deref(), Some("EP YC 9"));
    assert_eq!(text(&words(&[0; 12])), None);
    let cache = |name: &str, size: &str| Some((name.to_string(), size.to_string()));
    assert_eq!(cache_of([0x4163, 0x3c0_003f, 0x7fff, 1]), cache("L3", "32768K"));
    assert_eq!(cache_of([0x121, 0x1c0_003f, 0x3f, 0]), cache("L1d", "32K"));
}

#[test]
fn what_other_systems_say_is_read() {
    let mac = macos(
        "machdep.cpu.brand_string: Apple M2\nhw.cpufamily: 3660830781\nhw.cpusubfamily: 2\n\
         hw.l1dcachesize: 65536\nhw.l2cachesize: 4194304\nhw.memsize: 17179869184\n",
    );
    assert_eq!(mac.cpu.as_deref(), Some("Apple M2"));
    assert_eq!((mac.cpu_family, mac.cpu_model), (Some(3_660_830_781), Some(2)));
    assert_eq!((mac.caches["L1d"].as_str(), mac.caches["L2"].as_str()), ("64K", "4096K"));
    assert_eq!((mac.caches.len(), mac.memory_bytes), (2, Some(1 << 34)));
    let windows = windows(
        "\r\nHKEY_LOCAL_MACHINE\\HARDWARE\\DESCRIPTION\\System\\CentralProcessor\\0\r\n    \
         Identifier    REG_SZ    Intel64 Family 6 Model 143 Stepping 8\r\n    \
         ProcessorNameString    REG_SZ    Intel(R) Xeon(R)   Gold\r\n",
    );
    assert_eq!(windows.cpu.as_deref(), Some("Intel(R) Xeon(R) Gold"));
    assert_eq!(
        (windows.cpu_family, windows.cpu_model, windows.cpu_stepping),
        (Some(6), Some(143), Some(8))
    );
    let arm = linux(
        "processor\t: 0\nFeatures\t: fp asimd\nCPU implementer\t: 0x41\nCPU variant\t: 0x3\n\
         CPU part\t: 0xd0c\nCPU revision\t: 1\n",
    );
    assert_eq!((arm.cpu_family, arm.cpu_model, arm.cpu_stepping), (Some(3), Some(0xd0c), Some(1)));
    assert!(arm.cpu_flags.is_some() && arm.cpu_vendor.as_deref() == Some("0x41"));
    for nothing in [macos(""), windows_of_nothing(), linux("no colon")] {
        assert_eq!(nothing, Hardware::default());
    }
}

fn windows_of_nothing() -> Hardware {
    windows("ERROR: The system was unable to find the specified registry key or value.")
}
